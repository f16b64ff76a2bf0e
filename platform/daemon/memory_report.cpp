#include "platform/daemon/memory_report.h"

#include <cstdio>

#include "platform/daemon/cooperation.h"
#include "platform/daemon/exchange.h"
#include "platform/daemon/perception.h"
#include "platform/daemon/radio_link.h"
#include "platform/link/peer_exchange.h"
#include "slam/slam.h"

namespace zenith {

MemoryTable daemon_memory(const DaemonConfig& config) {
  MemoryTable table = Slam::memory_table(config.slam);
  if (config.radio.enabled && !config.radio.key_file.empty()) {
    table.add(PeerExchange::memory_table());
    table.add("exchange: radio", sizeof(RadioLink) - sizeof(PeerExchange));
  }
  table.add("threads: queues, snapshots, state",
            sizeof(Exchange) + sizeof(Perception) + sizeof(Cooperation));
  return table;
}

std::string memory_text(const MemoryTable& table) {
  const auto line = [](const char* name, std::size_t bytes) {
    char text[96];
    std::snprintf(text, sizeof text, "  %-48s %8.3f MiB\n", name,
                  static_cast<double>(bytes) / (1024.0 * 1024.0));
    return std::string(text);
  };
  std::string all;
  for (const MemoryPart& part : table.parts()) all += line(part.name, part.bytes);
  return all + line("total", table.total());
}

}  // namespace zenith
