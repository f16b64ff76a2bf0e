// zenith key: the secret that the robots of a fleet share.

#include <cstdio>
#include <memory>
#include <string>

#include "platform/link/fleet_key.h"
#include "tools/commands.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(Robots believe whoever has the key of their fleet. Make one, copy it to all robots, name it in
their configuration (radio.key_file):

  zenith key new fleet.key
  scp fleet.key robot1:/etc/zenith/fleet.key

The file must be readable by its owner alone (0600), or by root and the group of the service:

  chown root:zenith /etc/zenith/fleet.key && chmod 640 /etc/zenith/fleet.key

To change the key, put a new one in front of it, copy the file to all robots, and have them read it
again, one after the other:

  zenith key rotate fleet.key
  scp fleet.key robot1:/etc/zenith/fleet.key && ssh robot1 systemctl reload zenithd

Robots with the new file hear those that still have the old one, but not the other way round until
those have it, too; nothing of the maps is lost meanwhile. For no gap at all go two rounds: after
`rotate` do `zenith key swap fleet.key`, so that all robots get to know the new key while they still
use the old one; then `swap` again, copy and reload again. Rotate once more to be rid of the old key.

  zenith key show fleet.key       which keys it holds, without giving them away)";

int show(const std::string& file) {
  const auto keys = read_fleet_keys(file);
  if (!keys.ok()) return fail(keys.error());
  std::printf("key %s\n", keys_text(*keys).c_str());
  return 0;
}

int change(const std::string& file, Status (*change_file)(const std::filesystem::path&)) {
  if (const Status changed = change_file(file); !changed) return fail(changed.error());
  std::printf("%s: ", file.c_str());
  return show(file);
}

}  // namespace

void add_key_command(CLI::App& app, int& exit_code) {
  CLI::App* key = app.add_subcommand("key", "Make, change and show the key of a fleet");
  key->footer(kHelp);
  key->require_subcommand(1);
  const auto file = std::make_shared<std::string>();
  const auto add = [&](const char* name, const char* text, auto run) {
    CLI::App* command = key->add_subcommand(name, text);
    command->add_option("FILE", *file, "the key file")->required();
    command->callback([file, run, &exit_code] { exit_code = run(*file); });
  };
  add("new", "a new key in a new file",
      [](const std::string& f) { return change(f, create_fleet_key); });
  add("rotate", "a new key in front of the present one",
      [](const std::string& f) { return change(f, rotate_fleet_key); });
  add("swap", "of two keys the other one seals from now on; both open",
      [](const std::string& f) { return change(f, swap_fleet_keys); });
  add("show", "two bytes by which keys can be told apart", show);
}

}  // namespace zenith::tools
