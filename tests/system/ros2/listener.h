#pragma once
// Another participant of the bridge's DDS domain, which asks for topics as ROS 2's nodes do.

#include <dds/dds.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/system/process.h"
#include "tools/ros2/topic_types.h"

namespace zenith {

inline constexpr std::uint32_t kTestDomain = 89;

// On the loopback interface, without multicast, apart from all other tests: for this process and
// those that it starts.
inline void use_loopback_domain() {
  const std::string tag = "zenith-test-" + std::to_string(::getpid());
  const std::string uri =
      "<General><Interfaces><NetworkInterface name='lo'/></Interfaces>"
      "<AllowMulticast>false</AllowMulticast></General>"
      "<Discovery><Tag>" +
      tag +
      "</Tag><ParticipantIndex>auto</ParticipantIndex>"
      "<MaxAutoParticipantIndex>60</MaxAutoParticipantIndex>"
      "<Peers><Peer address='127.0.0.1'/></Peers></Discovery>";
  ::setenv("CYCLONEDDS_URI", uri.c_str(), 1);
  ::unsetenv("ROS_LOCALHOST_ONLY");
  ::unsetenv("ROS_DOMAIN_ID");
}

// What a ROS 2 node asks for.
struct Wish {
  int depth = 10;
  bool latched = false;  // transient local
  bool best_effort = false;
};

class Listener {
 public:
  Listener() : participant_(dds_create_participant(kTestDomain, nullptr, nullptr)) {}
  ~Listener() { dds_delete(participant_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  dds_entity_t participant() const { return participant_; }

  dds_entity_t subscribe(const std::string& topic, const ros2::TopicType& type, Wish wish = {}) {
    const dds_entity_t described =
        dds_create_topic(participant_, type.descriptor, topic.c_str(), nullptr, nullptr);
    const std::unique_ptr<dds_qos_t, void (*)(dds_qos_t*)> qos(
        dds_create_qos(), [](dds_qos_t* q) { dds_delete_qos(q); });
    dds_qset_reliability(qos.get(),
                         wish.best_effort ? DDS_RELIABILITY_BEST_EFFORT : DDS_RELIABILITY_RELIABLE,
                         DDS_INFINITY);
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, wish.depth);
    dds_qset_durability(qos.get(),
                        wish.latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    dds_data_representation_id_t plain = DDS_DATA_REPRESENTATION_XCDR1;
    dds_qset_data_representation(qos.get(), 1, &plain);
    return dds_create_reader(participant_, described, qos.get(), nullptr);
  }

  // Until the bridge's writer is known here. It may not know this reader yet: what is not latched
  // is still lost then.
  bool matched(dds_entity_t reader, double limit_s = kPatience_s) const {
    return wait_until(limit_s, [&] {
      dds_subscription_matched_status_t status = {};
      return dds_get_subscription_matched_status(reader, &status) == DDS_RETCODE_OK &&
             status.current_count > 0;
    });
  }

 private:
  dds_entity_t participant_;
};

// The next message for which `wanted` holds; others are taken and forgotten. `wanted` looks at the
// message while it is there, and copies what the test needs.
template <typename Message>
bool take_until(dds_entity_t reader, const std::function<bool(const Message&)>& wanted,
                double limit_s = kPatience_s) {
  return wait_until(limit_s, [&] {
    while (true) {
      void* sample = nullptr;
      dds_sample_info_t info = {};
      if (dds_take(reader, &sample, &info, 1, 1) != 1) return false;
      const bool found = info.valid_data && wanted(*static_cast<const Message*>(sample));
      dds_return_loan(reader, &sample, 1);
      if (found) return true;
    }
  });
}

}  // namespace zenith
