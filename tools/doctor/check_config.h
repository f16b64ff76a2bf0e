#pragma once

#include <filesystem>
#include <optional>

#include "platform/daemon/config.h"
#include "tools/doctor/finding.h"

namespace zenith::tools {

// Reads it into `config`; one finding for each mistake. Without a name the usual place is looked
// at, then defaults are taken. `config` stays empty when the file is wrong.
Findings check_config(const std::filesystem::path& file, std::optional<DaemonConfig>& config,
                      const std::filesystem::path& usual = "/etc/zenith/zenith.toml");

}  // namespace zenith::tools
