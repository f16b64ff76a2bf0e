#include "tools/ros2/participant.h"

#include <dds/dds.h>

#include <cstdlib>
#include <memory>

namespace zenith::ros2 {
namespace {

using Qos = std::unique_ptr<dds_qos_t, void (*)(dds_qos_t*)>;

Qos new_qos() {
  return {dds_create_qos(), [](dds_qos_t* qos) { dds_delete_qos(qos); }};
}

Error dds_error(const std::string& what, dds_return_t code) {
  return {what + ": " + dds_strretcode(code)};
}

// Before the participant; without it the domain follows CYCLONEDDS_URI alone.
Result<Entity> make_local_domain(std::uint32_t domain) {
  std::string config =
      "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/>"
      "</Interfaces></General></Domain></CycloneDDS>";
  const char* more = std::getenv("CYCLONEDDS_URI");
  if (more != nullptr && *more != '\0') config += std::string(",") + more;
  const dds_entity_t made = dds_create_domain(domain, config.c_str());
  if (made < 0) return dds_error("the DDS domain on this computer alone", made);
  return Entity(made);
}

// What ROS 2 asks of a writer, and tells of it.
Qos writer_qos(const TopicType& type, const Quality& quality) {
  Qos qos = new_qos();
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, quality.depth);
  dds_qset_durability(qos.get(),
                      quality.latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (quality.latched) {
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, quality.depth,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  dds_qset_writer_data_lifecycle(qos.get(), false);
  dds_data_representation_id_t plain = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(qos.get(), 1, &plain);
  const std::string hash = "typehash=" + std::string(type.hash) + ";";
  dds_qset_userdata(qos.get(), hash.data(), hash.size());
  return qos;
}

}  // namespace

Entity::~Entity() {
  if (handle_ > 0) (void)dds_delete(handle_);
}

Result<Participant> Participant::join(std::uint32_t domain, bool localhost) {
  Participant out;
  if (localhost) {
    auto made = make_local_domain(domain);
    if (!made) return made.error();
    out.domain_ = std::move(*made);
  }
  Qos qos = new_qos();
  constexpr char kEnclave[] = "enclave=/;";  // by which ROS 2 knows its own
  dds_qset_userdata(qos.get(), kEnclave, sizeof kEnclave - 1);
  const dds_entity_t made = dds_create_participant(domain, qos.get(), nullptr);
  if (made < 0) {
    return dds_error("DDS domain " + std::to_string(domain) +
                         " could not be joined; is there a network interface, and is "
                         "CYCLONEDDS_URI right",
                     made);
  }
  out.entity_ = Entity(made);
  return out;
}

Result<Writer> Writer::make(const Participant& participant, const std::string& topic,
                            const TopicType& type, const Quality& quality) {
  Writer out;
  out.topic_ = topic;
  const dds_entity_t described =
      dds_create_topic(participant.get(), type.descriptor, topic.c_str(), nullptr, nullptr);
  if (described < 0) return dds_error("topic " + topic, described);
  out.description_ = Entity(described);
  const Qos qos = writer_qos(type, quality);
  const dds_entity_t made = dds_create_writer(participant.get(), described, qos.get(), nullptr);
  if (made < 0) return dds_error("writer of " + topic, made);
  out.writer_ = Entity(made);
  return out;
}

Status Writer::write(const void* message) const {
  const dds_return_t code = dds_write(writer_.get(), message);
  if (code != DDS_RETCODE_OK) return dds_error(topic_ + " was not written", code);
  return {};
}

}  // namespace zenith::ros2
