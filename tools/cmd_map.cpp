// zenith map: stored maps: what there is, whether it is whole, out of it and into it.

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "platform/base/printable.h"
#include "platform/storage/map_store.h"
#include "tools/commands.h"
#include "tools/map_export.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;
using storage::DecodedMap;
using storage::MapFault;
using storage::StoredMap;

constexpr const char* kStateFolder = "/var/lib/zenith";

constexpr const char* kHelp =
    R"(The service keeps its map in /var/lib/zenith (map-0, map-1), and beside it what was mapped in
sessions that ended before the robot found itself in that map (session-1-0, ...). A folder stands for
the newest checkpoint of the map.

  zenith map list                                  the maps in the folder
  zenith map show /var/lib/zenith                  what the newest one holds
  zenith map check /var/lib/zenith/map-0.zenmap    whether it is whole
  zenith map export /var/lib/zenith map.png        a picture; also .ply and .csv
  zenith map import anna.zenmap /var/lib/zenith    begin with another robot's map

Import while the service is stopped (systemctl stop zenithd): it is refused as long as another program
has the folder. What was there before is set aside beside it. A copy for another robot is the file itself: cp, scp.)";

// Reads without changing anything.
DecodedMap read_map(const fs::path& file) {
  storage::DiskFolder folder(file.has_parent_path() ? file.parent_path().string() : ".");
  const auto bytes = folder.read(file.filename().string(), storage::kMaxMapBytes);
  if (bytes.ok()) return storage::decode_map(*bytes);
  DecodedMap out;
  out.fault = MapFault::kDamaged;
  out.reason = bytes.error().message;
  return out;
}

std::vector<fs::path> generations(const fs::path& folder, const std::string& name) {
  std::vector<fs::path> files;
  std::error_code code;
  for (std::size_t i = 0; i < storage::kGenerations; ++i) {
    const fs::path file = folder / storage::generation_file(name, i);
    // A link that leads nowhere is there as well, and told when it is read.
    if (fs::exists(fs::symlink_status(file, code))) files.push_back(file);
  }
  return files;
}

std::vector<fs::path> all_generations(const fs::path& folder) {
  std::vector<fs::path> files = generations(folder, storage::kMainMap);
  for (const char* name : storage::kSessionMaps) {
    const auto further = generations(folder, name);
    files.insert(files.end(), further.begin(), further.end());
  }
  return files;
}

// A file, or the newest whole main map of a folder.
Result<StoredMap> find_map(const fs::path& path) {
  std::error_code code;
  if (!fs::is_directory(path, code)) {
    DecodedMap decoded = read_map(path);
    if (decoded.fault != MapFault::kNone) return Error{path.string() + ": " + decoded.reason};
    return std::move(decoded.map);
  }
  StoredMap newest;
  bool any = false;
  for (const fs::path& file : generations(path, storage::kMainMap)) {
    DecodedMap decoded = read_map(file);
    if (decoded.fault != MapFault::kNone) continue;
    if (any && newest.head.checkpoint >= decoded.map.head.checkpoint) continue;
    newest = std::move(decoded.map);
    any = true;
  }
  if (!any) return Error{path.string() + ": expected a stored map, found none that can be read"};
  return newest;
}

std::string when(std::int64_t saved_s) {
  if (saved_s == 0) return "at an unknown time";
  const auto seconds = static_cast<std::time_t>(saved_s);
  std::tm parts = {};
  char text[64] = "";
  if (gmtime_r(&seconds, &parts) != nullptr) {
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S UTC", &parts);
  }
  return text;
}

int list(const std::string& folder) {
  std::error_code code;
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    const std::string name = entry.path().filename().string();
    if (name.find(".zenmap") != std::string::npos) files.insert(entry.path());
  }
  for (const fs::path& file : files) {
    const std::string name = printable(file.filename().string());  // one line each
    const DecodedMap decoded = read_map(file);
    if (decoded.fault != MapFault::kNone) {
      std::printf("%-24s %s\n", name.c_str(), decoded.reason.c_str());
      continue;
    }
    std::printf("%-24s %5zu landmarks of %s, checkpoint %llu, %s\n", name.c_str(),
                decoded.map.landmarks.size(), decoded.map.head.robot.c_str(),
                static_cast<unsigned long long>(decoded.map.head.checkpoint),
                when(decoded.map.head.saved_s).c_str());
  }
  if (code) return fail({folder + ": " + code.message()});
  if (files.empty()) std::printf("no maps in %s\n", folder.c_str());
  return 0;
}

int show(const std::string& path) {
  const auto map = find_map(path);
  if (!map.ok()) return fail(map.error());
  float low[2] = {0, 0};
  float high[2] = {0, 0};
  std::size_t looks = 0;
  for (const LandmarkRecord& l : map->landmarks) {
    const float at[2] = {l.x_m, l.y_m};
    for (int k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], at[k]);
      high[k] = std::max(high[k], at[k]);
    }
    looks += l.appearance_count;
  }
  std::printf("map          %016llx, checkpoint %llu, written %s\n",
              static_cast<unsigned long long>(map->head.map),
              static_cast<unsigned long long>(map->head.checkpoint),
              when(map->head.saved_s).c_str());
  std::printf("robot        %s, camera at %.2f m, rectified to %.0f degrees\n",
              map->head.robot.c_str(), map->head.camera_height_m, map->head.rectified_fov_deg);
  std::printf("landmarks    %zu with %zu looks\n", map->landmarks.size(), looks);
  std::printf("extent       x %.1f .. %.1f m, y %.1f .. %.1f m\n", static_cast<double>(low[0]),
              static_cast<double>(high[0]), static_cast<double>(low[1]),
              static_cast<double>(high[1]));
  return 0;
}

int check(const std::vector<std::string>& paths) {
  int code = 0;
  for (const std::string& path : paths) {
    std::error_code ignored;
    const bool folder = fs::is_directory(path, ignored);
    const auto files = folder ? all_generations(path) : std::vector<fs::path>{path};
    if (files.empty()) code = fail({path + ": expected stored maps, found none"});
    for (const fs::path& file : files) {
      const DecodedMap decoded = read_map(file);
      if (decoded.fault == MapFault::kNone) {
        std::printf("%s: whole, %zu landmarks\n", file.c_str(), decoded.map.landmarks.size());
      } else {
        code = fail({file.string() + ": " + decoded.reason});
      }
    }
  }
  return code;
}

int export_to(const std::string& path, const std::string& file) {
  const auto map = find_map(path);
  if (!map.ok()) return fail(map.error());
  const Status written = export_map(*map, file);
  return written ? 0 : fail(written.error());
}

int import_into(const std::string& path, const std::string& folder) {
  auto map = find_map(path);
  if (!map.ok()) return fail(map.error());
  storage::DiskFolder disk(folder);
  const storage::LockTry tried = disk.lock(storage::this_program(""));
  if (!tried.ours()) return fail({tried.why});
  storage::MapStore store(disk);
  const storage::LoadedMap before = store.load();
  warn(before.messages);
  if (const Status aside = store.set_all_aside(); !aside) return fail(aside.error());
  if (const Status saved = store.save(*map); !saved) return fail(saved.error());
  std::printf("%s: %zu landmarks of %s; the next start begins with them\n", folder.c_str(),
              map->landmarks.size(), map->head.robot.c_str());
  return 0;
}

}  // namespace

void add_map_command(CLI::App& app, int& exit_code) {
  CLI::App* map = app.add_subcommand("map", "List, show, check, export and import stored maps");
  map->footer(kHelp);
  map->require_subcommand(1);
  struct Words {
    std::string path = kStateFolder;
    std::string to;
    std::vector<std::string> paths;
  };
  const auto words = std::make_shared<Words>();
  CLI::App* command = map->add_subcommand("list", "the maps in a folder");
  command->add_option("FOLDER", words->path, "the folder")->capture_default_str();
  command->callback([words, &exit_code] { exit_code = list(words->path); });
  command = map->add_subcommand("show", "what a map holds");
  command->add_option("MAP", words->path, "a file or a folder")->capture_default_str();
  command->callback([words, &exit_code] { exit_code = show(words->path); });
  command = map->add_subcommand("check", "whether maps are whole; exit code 1 when one is not");
  command->add_option("MAP", words->paths, "files or folders")->required();
  command->callback([words, &exit_code] { exit_code = check(words->paths); });
  command = map->add_subcommand("export", "a map for other programs");
  command->add_option("MAP", words->path, "a file or a folder")->required();
  command->add_option("FILE", words->to, "what to write: .ply, .csv or .png")->required();
  command->callback([words, &exit_code] { exit_code = export_to(words->path, words->to); });
  command = map->add_subcommand("import", "begin with this map, of whichever robot");
  command->add_option("MAP", words->path, "a file or a folder")->required();
  command->add_option("FOLDER", words->to, "the service's state folder")->required();
  command->callback([words, &exit_code] { exit_code = import_into(words->path, words->to); });
}

}  // namespace zenith::tools
