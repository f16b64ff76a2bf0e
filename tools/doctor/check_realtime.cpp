#include <unistd.h>

#include <map>
#include <sstream>

#include "tools/doctor/check_machine.h"

namespace zenith::tools {
namespace {

// The pages of a daemon with its map: 71 MB and libraries.
constexpr std::uint64_t kNeededLocked = std::uint64_t{192} * 1024 * 1024;
constexpr const char* kUnitFix = "systemctl edit zenithd    # [Service]\n";

std::string kib(std::uint64_t bytes) {
  return bytes == RealtimeLimits::kUnlimited ? "no limit" : std::to_string(bytes / 1024) + " KiB";
}

// "8388608" or "unlimited" in the column of soft limits.
bool parse_limit(const std::string& word, std::uint64_t& value) {
  if (word == "unlimited") {
    value = RealtimeLimits::kUnlimited;
    return true;
  }
  std::istringstream in(word);
  return static_cast<bool>(in >> value);
}

}  // namespace

bool read_process_limits(const MachineFiles& files, int pid, LimitFacts& facts) {
  const std::string folder = "/proc/" + std::to_string(pid);
  const auto text = files.read(folder + "/limits");
  if (!text) return false;
  RealtimeLimits limits;
  std::istringstream lines(*text);
  std::string line;
  int found = 0;
  while (std::getline(lines, line)) {
    const auto take = [&](const std::string& name, std::uint64_t& value) {
      if (line.rfind(name, 0) != 0) return;
      std::istringstream rest(line.substr(name.size()));
      std::string soft;
      found += (rest >> soft) && parse_limit(soft, value);
    };
    take("Max realtime priority", limits.fifo_priority);
    take("Max locked memory", limits.locked_bytes);
  }
  if (found != 2) return false;
  facts.limits = limits;
  facts.whose = "the running zenithd";
  facts.is_root =
      files.read(folder + "/status").value_or("").find("\nUid:\t0\t") != std::string::npos;
  return true;
}

Finding check_fifo(const RealtimeConfig& config, const LimitFacts& facts) {
  const std::string what = "realtime priority";
  if (config.priority == 0) return skip(what, "realtime.priority = 0 asks for none");
  const std::string allowed = std::to_string(facts.limits.fifo_priority) + " for " + facts.whose;
  if (facts.is_root) return ok(what, "root may take any");
  if (facts.limits.fifo_priority >= static_cast<std::uint64_t>(config.priority)) {
    return ok(what, allowed);
  }
  return warn(what, allowed + ", " + std::to_string(config.priority) + " is asked for",
              "set LimitRTPRIO= in the unit: without it a busy computer makes frames late",
              kUnitFix + ("LimitRTPRIO=" + std::to_string(config.priority)));
}

Finding check_locked_memory(const RealtimeConfig& config, const LimitFacts& facts) {
  const std::string what = "locked memory";
  if (!config.lock_memory) return skip(what, "realtime.lock_memory = false asks for none");
  if (facts.is_root) return ok(what, "root may lock all");
  const std::string allowed = kib(facts.limits.locked_bytes) + " for " + facts.whose;
  if (facts.limits.locked_bytes >= kNeededLocked) return ok(what, allowed);
  return warn(what, allowed + ", the daemon needs " + kib(kNeededLocked),
              "set LimitMEMLOCK= in the unit: without it a frame may wait for a page",
              std::string(kUnitFix) + "LimitMEMLOCK=infinity");
}

Finding check_cpu_dma_latency(const RealtimeConfig& config, const MachineFiles& files) {
  const std::string what = "cpu_dma_latency";
  const std::string path = "/dev/cpu_dma_latency";
  if (!config.hold_cpu_awake) return skip(what, "realtime.hold_cpu_awake = false asks for none");
  if (!files.exists(path)) {
    return warn(what, path + " is not there",
                "the CPUs may sleep deeply and wake up late; a kernel with CPU_IDLE has it");
  }
  if (::access(files.at(path).c_str(), W_OK) == 0) return ok(what, path + " can be written");
  return warn(what, path + " cannot be written by this user",
              "give the service's group write access by a udev rule, else CPUs may wake up late",
              "echo 'KERNEL==\"cpu_dma_latency\", GROUP=\"zenith\", MODE=\"0660\"' | "
              "sudo tee /etc/udev/rules.d/70-zenith-cpu.rules");
}

Finding check_governor(const MachineFiles& files) {
  const std::string what = "cpu governor";
  const std::string base = "/sys/devices/system/cpu";
  std::map<std::string, int> governors;
  for (const std::string& cpu : files.list(base)) {
    if (const auto governor = files.read(base + "/" + cpu + "/cpufreq/scaling_governor")) {
      ++governors[*governor];
    }
  }
  if (governors.empty()) return ok(what, "the kernel does not change the CPUs' frequency");
  std::string text;
  bool slow = false;
  for (const auto& [name, count] : governors) {
    text += (text.empty() ? "" : ", ") + name + " on " + std::to_string(count);
    slow = slow || name == "powersave" || name == "conservative";
  }
  // intel_pstate's "powersave" follows the load; plain cpufreq's stays at the lowest frequency.
  const auto driver = files.read(base + "/cpu0/cpufreq/scaling_driver");
  if (driver && driver->rfind("intel_pstate", 0) == 0) slow = false;
  if (driver && driver->rfind("amd-pstate-epp", 0) == 0) slow = false;
  if (!slow) return ok(what, text);
  return warn(what, text, "schedutil or performance keep steps quick",
              "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor");
}

Finding check_preemption(const MachineFiles& files) {
  const std::string what = "kernel preemption";
  if (files.read("/sys/kernel/realtime") == "1") return ok(what, "PREEMPT_RT");
  const std::string version = files.read("/proc/version").value_or("");
  if (version.find("PREEMPT_RT") != std::string::npos) return ok(what, "PREEMPT_RT");
  if (version.find("PREEMPT_DYNAMIC") != std::string::npos) {
    return ok(what, "PREEMPT_DYNAMIC: good for frames every 33 ms");
  }
  if (version.find("PREEMPT") != std::string::npos) return ok(what, "PREEMPT");
  return warn(what, "none: calls into the kernel are not interrupted",
              "usually good enough; a kernel with PREEMPT or PREEMPT_RT wakes up more evenly",
              "apt-cache search linux-image-rt");
}

Finding check_rt_throttling(const RealtimeConfig& config, const MachineFiles& files) {
  const std::string what = "realtime budget";
  if (config.priority == 0) return skip(what, "realtime.priority = 0 asks for none");
  const auto runtime = files.number("/proc/sys/kernel/sched_rt_runtime_us");
  const auto period = files.number("/proc/sys/kernel/sched_rt_period_us");
  if (!runtime || !period || *period <= 0) {
    return skip(what, "/proc/sys/kernel/sched_rt_runtime_us cannot be read");
  }
  if (*runtime < 0) return ok(what, "no limit");
  const long long percent = 100 * *runtime / *period;
  const std::string text = std::to_string(percent) + " % of each CPU";
  if (percent >= 80) return ok(what, text);
  return fail(what, text + " for realtime threads",
              "raise sched_rt_runtime_us to 950000: the perception thread would be stopped",
              "echo 950000 | sudo tee /proc/sys/kernel/sched_rt_runtime_us");
}

}  // namespace zenith::tools
