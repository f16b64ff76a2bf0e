#pragma once
// All checks of `zenith doctor`, in the order in which they are told.

#include <filesystem>
#include <functional>
#include <string>

#include "tools/doctor/finding.h"

namespace zenith::tools {

struct DoctorPlan {
  std::filesystem::path config;  // empty: the usual place, or defaults
  std::string state_folder = "/var/lib/zenith";
  double watch_s = 2.0;  // how long the camera and the CAN bus are watched
};

// `tell` hears each finding as soon as it is known.
Findings run_doctor(const DoctorPlan& plan, const std::function<void(const Finding&)>& tell);

}  // namespace zenith::tools
