#pragma once
// What the telemetry socket says, a line of JSON each. docs/daemon.md describes them.

#include <string_view>

#include "platform/daemon/cooperation.h"
#include "platform/daemon/deadlines.h"
#include "platform/daemon/health.h"
#include "platform/daemon/json_line.h"
#include "platform/daemon/link_status.h"
#include "platform/daemon/map_keeper.h"
#include "platform/daemon/perception_report.h"

namespace zenith {

// The first line that a reader gets.
void write_hello(JsonLine& line, std::string_view robot, std::string_view version,
                 std::string_view devices, Time started);
// At the end of a line: what to add to its times for those of the system's clock, CLOCK_REALTIME.
void write_clock(JsonLine& line, Duration system_offset);
void write_pose(JsonLine& line, const PerceptionReport& report);
void write_alignment(JsonLine& line, const PeerReport& peer, std::string_view name, Time stamp);
void write_health(JsonLine& line, const PerceptionReport& report, const Health& health,
                  const CooperationCounters& cooperation);
void write_stored_map(JsonLine& line, const MapStatus& status, Time now);
// The gravest reasons first.
void write_verdict(VerdictLine& line, const SetupVerdict& verdict, Time now);
void write_radio(JsonLine& line, const LinkStatus& status, Time now);
void write_peer(JsonLine& line, const LinkPeer& peer, Time now);
void write_deadlines(JsonLine& line, const Deadlines& deadlines);

}  // namespace zenith
