#pragma once
// The configuration as texts, made of the list of keys: what config/zenith.toml and
// docs/configuration.md hold. A test compares them.

#include <string>

namespace zenith {

// All keys with their defaults and what they mean, as a file that zenithd reads.
std::string annotated_config();

// The reference page.
std::string config_reference();

}  // namespace zenith
