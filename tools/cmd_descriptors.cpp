// zenith descriptors: how well the compact descriptor recognises landmarks, against full NCC.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/atomic_output.h"
#include "tools/commands.h"
#include "tools/descriptors/comparison.h"
#include "tools/report/table.h"
#include "tools/simulate.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(Takes looks of the same landmarks from different frames, at least 0.5 m apart or turned by
30 degrees, and lets each descriptor find the right landmark among all of the sequence. Worlds:
which look is which landmark is known from the true poses and the building. Recordings: from the
map that is made of them. Photographs: turned, shifted, brightened and noised again.

Examples:
  zenith descriptors corridor-rooms lamps-off heights
  zenith descriptors rec/r1 --photos ceilings --json descriptors.json
  zenith descriptors corridor-rooms --looks 8

What the columns mean:
  rank-1     queries whose most similar landmark is the right one
  accepted   right pairs at or above the threshold
  wrong      wrong pairs at or above it
  wrong@80   wrong pairs above the threshold that accepts 80 % of the right ones
  turned     queries whose direction is off by more than 0.6 rad: no descriptor can know them)";

constexpr int kMinLooks = 3;

struct DescriptorsOptions {
  std::vector<std::string> subjects;
  std::string photos;
  std::string json_path;
  std::uint64_t seed = 1;
  double duration_s = 0.0;
  bool ceilings = false;
  ComparisonSettings settings;
};

std::string percent(double share, int decimals) {
  return fixed(100.0 * share, decimals) + " %";
}

void print_comparison(const Comparison& c) {
  std::printf("%s, %s: %d queries among %d landmarks, turned %s\n", c.sequence.c_str(),
              c.views.c_str(), c.queries, c.landmarks, percent(c.turned, 1).c_str());
  Table table({"descriptor", "bytes", "rank-1", "accepted", "wrong", "wrong@80"});
  for (const DescriptorScore& s : c.scores) {
    table.add({s.kind.name, std::to_string(s.kind.bytes), percent(s.rank1, 1),
               percent(s.true_accept, 1), percent(s.false_accept, 2), percent(s.false_at_80, 2)});
  }
  std::printf("%s\n", table.text(2).c_str());
  std::fflush(stdout);
}

nlohmann::json to_json(const Comparison& c) {
  nlohmann::json out = {{"sequence", c.sequence}, {"views", c.views},   {"landmarks", c.landmarks},
                        {"queries", c.queries},   {"turned", c.turned}, {"scores", {}}};
  for (const DescriptorScore& s : c.scores) {
    out["scores"].push_back({{"descriptor", s.kind.name},
                             {"bytes", s.kind.bytes},
                             {"rank1", s.rank1},
                             {"true_accept", s.true_accept},
                             {"false_accept", s.false_accept},
                             {"false_accept_at_80", s.false_at_80}});
  }
  return out;
}

void compare(LookSequence sequence, const DescriptorsOptions& options, nlohmann::json& json) {
  if (!sequence.synthetic) drop_rare_landmarks(sequence, kMinLooks);
  for (const Comparison& c : compare_descriptors(sequence, options.settings)) {
    print_comparison(c);
    json.push_back(to_json(c));
  }
}

int run_descriptors(const DescriptorsOptions& options) {
  if (options.subjects.empty() && options.photos.empty()) {
    return fail({"descriptors needs a WORLD, a recording or --photos DIR"}) + 1;
  }
  nlohmann::json json = nlohmann::json::array();
  for (const std::string& subject : options.subjects) {
    const bool recording = std::filesystem::is_directory(subject);
    if (!recording) {
      if (const Status known = check_worlds({subject}); !known) return fail(known.error());
    }
    auto looks = recording
                     ? mapped_looks(subject, options.seed)
                     : simulated_looks(subject, options.seed, options.duration_s, options.ceilings);
    if (!looks.ok()) return fail(looks.error());
    compare(std::move(*looks), options, json);
  }
  if (!options.photos.empty()) {
    auto looks = photo_looks(options.photos, options.seed);
    if (!looks.ok()) return fail(looks.error());
    compare(std::move(*looks), options, json);
  }
  if (options.json_path.empty()) return 0;
  const Status written = write_file(options.json_path, json.dump(2) + "\n");
  return written ? 0 : fail(written.error());
}

}  // namespace

void add_descriptors_command(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<DescriptorsOptions>();
  CLI::App* command =
      app.add_subcommand("descriptors", "Measure the compact descriptor against full NCC");
  command->footer(kHelp);
  command->add_option("SUBJECT", options->subjects, "worlds by name or file, or recordings");
  command->add_option("--photos", options->photos, "a folder of photographs of ceilings");
  command->add_option("--seed", options->seed, "of the worlds, and of the choice of looks")
      ->capture_default_str();
  command->add_option("--duration", options->duration_s, "seconds of a world at most, 0: all")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--ceilings", options->ceilings, "of worlds, leave the walls out");
  command->add_option("--looks", options->settings.stored_looks, "stored looks of a landmark")
      ->check(CLI::Range(1, kMaxAppearances))
      ->capture_default_str();
  command->add_option("--threshold", options->settings.threshold, "NCC of the accepted pairs")
      ->check(CLI::Range(-1.0, 1.0))
      ->capture_default_str();
  command->add_option("--json", options->json_path, "write all figures to this file");
  command->callback([options, &exit_code] {
    options->settings.seed = options->seed;
    exit_code = run_descriptors(*options);
  });
}

}  // namespace zenith::tools
