#include <sys/statvfs.h>
#include <sys/timex.h>

#include <algorithm>

#include "platform/linux/clock.h"
#include "tools/doctor/check_machine.h"
#include "tools/doctor/formatted.h"

namespace zenith::tools {

// --- clock ---------------------------------------------------------------------------------------

ClockFacts read_clock() {
  ClockFacts facts;
  timex state = {};
  const int result = ::adjtimex(&state);
  facts.readable = result >= 0;
  facts.synchronised = facts.readable && result != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
  facts.error_s = static_cast<double>(state.esterror) * 1e-6;
  Time last = monotonic_now();
  for (int i = 0; i < 10'000; ++i) {
    const Time now = monotonic_now();
    facts.monotonic_rises = facts.monotonic_rises && now >= last;
    last = now;
  }
  return facts;
}

Finding check_clock_source(const MachineFiles& files) {
  const std::string what = "clock source";
  const std::string folder = "/sys/devices/system/clocksource/clocksource0/";
  const auto current = files.read(folder + "current_clocksource");
  if (!current || current->empty()) return skip(what, folder + " cannot be read");
  for (const char* slow : {"jiffies", "acpi_pm", "hpet", "refined-jiffies"}) {
    if (*current != slow) continue;
    return warn(what,
                *current + ": slow to read, or coarse; available: " +
                    files.read(folder + "available_clocksource").value_or("?"),
                "look why the kernel left the CPU's own counter (`dmesg | grep -i clocksource`)");
  }
  return ok(what, *current);
}

Finding check_clock_sync(const ClockFacts& facts) {
  const std::string what = "clock sync";
  if (!facts.readable) return skip(what, "the kernel does not tell");
  if (facts.synchronised) {
    return ok(what, "synchronised, error about " + formatted("%.3f s", facts.error_s));
  }
  return warn(what, "the wall clock is not synchronised",
              "the map does not need it, but logs and recordings of several robots do: run "
              "systemd-timesyncd or chrony",
              "sudo timedatectl set-ntp true");
}

Finding check_monotonic(const ClockFacts& facts) {
  const std::string what = "monotonic clock";
  if (facts.monotonic_rises) return ok(what, "rises");
  return fail(what, "CLOCK_MONOTONIC went back",
              "the kernel's clock source is broken: choose another one (clocksource= at boot)");
}

// --- heat and power ------------------------------------------------------------------------------

Finding check_temperature(const MachineFiles& files) {
  const std::string what = "temperature";
  const std::string base = "/sys/class/thermal";
  double hottest = -1000.0;
  std::string where;
  for (const std::string& zone : files.list(base)) {
    if (zone.rfind("thermal_zone", 0) != 0) continue;
    const auto milli = files.number(base + "/" + zone + "/temp");
    if (!milli || static_cast<double>(*milli) * 1e-3 <= hottest) continue;
    hottest = static_cast<double>(*milli) * 1e-3;
    where = files.read(base + "/" + zone + "/type").value_or(zone);
  }
  if (where.empty()) return skip(what, "no sensor in " + base);
  const std::string found = formatted("%.0f C", hottest) + " (" + where + ")";
  constexpr double kThrottles = 80.0;  // where a Raspberry Pi begins to slow down
  constexpr double kHot = 70.0;
  if (hottest >= kThrottles) {
    return fail(what, found, "boards slow down at 80 C: cool it, steps take longer than expected");
  }
  if (hottest >= kHot) return warn(what, found, "it will slow down at 80 C: see to its cooling");
  return ok(what, found);
}

Finding check_power(const MachineFiles& files) {
  const std::string what = "power supply";
  const std::string base = "/sys/class/hwmon";
  for (const std::string& sensor : files.list(base)) {
    const std::string folder = base + "/" + sensor;
    if (files.read(folder + "/name") != "rpi_volt") continue;
    if (files.number(folder + "/in0_lcrit_alarm").value_or(0) == 0) {
      return ok(what, "no under-voltage");
    }
    return fail(
        what, "under-voltage (" + folder + "/in0_lcrit_alarm)",
        "the supply or its cable is too weak: the board slows down and USB cameras drop out");
  }
  return skip(what, "this board does not measure it");
}

// --- the map's folder and its disk ---------------------------------------------------------------

Finding check_map_folder(const std::string& folder, const storage::FolderFacts& facts,
                         const std::string& robot, int daemon_pid) {
  const std::string what = "map folder";
  if (!facts.exists) {
    return fail(what, folder + " is not there",
                "the map is not kept: make it, or start the service, whose unit makes its own",
                "sudo install -d -o zenith -g zenith -m 750 " + folder);
  }
  if (!facts.is_folder) return fail(what, folder + " is no folder", "name another map.folder");
  const std::string found = folder + ", of " + facts.owner;
  if (facts.user && (facts.user->robot != robot || facts.user->program == "zenith")) {
    return fail(what, found + ", in use by " + storage::user_text(*facts.user),
                "one program writes a folder of maps: stop that one, or name another map.folder");
  }
  if (facts.user) return ok(what, found + ", in use by " + storage::user_text(*facts.user));
  if (daemon_pid != 0 && facts.lock_is_known) {
    return fail(what, found + ", and the running zenithd does not have it",
                "it says why: journalctl -u zenithd ZENITH_EVENT=map-not-kept");
  }
  if (!facts.writable) {
    return warn(what, found + ", cannot be written by this user", "the service's user must own it",
                "sudo chown -R zenith:zenith " + folder);
  }
  return ok(what, found + ", not in use");
}

double free_disk_mb(const std::string& folder) {
  struct statvfs disk = {};
  if (::statvfs(folder.c_str(), &disk) != 0) return -1.0;
  return static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize) * 1e-6;
}

Finding check_disk(const std::string& folder, double free_mb) {
  const std::string what = "disk";
  if (free_mb < 0.0) return skip(what, folder + " is not there: the service's unit makes it");
  const std::string found = formatted("%.0f MB", free_mb) + " free at " + folder;
  if (free_mb < 20.0) return fail(what, found, "make room: nothing can be kept or recorded");
  if (free_mb < 500.0) return warn(what, found, "a recording takes about 3 MB a second: make room");
  return ok(what, found);
}

}  // namespace zenith::tools
