#include "tests/system/lossy_wire.h"

#include <linux/bpf.h>
#include <linux/if_link.h>
#include <net/if.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cstdint>

namespace zenith {
namespace {

int bpf(bpf_cmd command, bpf_attr& attributes) {
  return static_cast<int>(::syscall(SYS_bpf, command, &attributes, sizeof attributes));
}

// if (random() < limit) drop else pass
std::array<bpf_insn, 6> loss_program(std::uint32_t limit) {
  const auto instruction = [](unsigned code, int offset, std::uint32_t value) {
    bpf_insn one = {};
    one.code = static_cast<std::uint8_t>(code);
    one.off = static_cast<std::int16_t>(offset);
    one.imm = static_cast<std::int32_t>(value);
    return one;  // of register 0
  };
  constexpr unsigned kCall = BPF_JMP | BPF_CALL;
  constexpr unsigned kIfLess = BPF_JMP32 | BPF_JLT | BPF_K;
  constexpr unsigned kSet = BPF_ALU64 | BPF_MOV | BPF_K;
  constexpr unsigned kReturn = BPF_JMP | BPF_EXIT;
  return {instruction(kCall, 0, BPF_FUNC_get_prandom_u32),
          instruction(kIfLess, 2, limit),
          instruction(kSet, 0, XDP_PASS),
          instruction(kReturn, 0, 0),
          instruction(kSet, 0, XDP_DROP),
          instruction(kReturn, 0, 0)};
}

}  // namespace

LossyWire::LossyWire(const char* interface, double share) {
  const auto program = loss_program(static_cast<std::uint32_t>(share * 4294967295.0));
  bpf_attr load = {};
  load.prog_type = BPF_PROG_TYPE_XDP;
  load.insns = reinterpret_cast<std::uint64_t>(program.data());
  load.insn_cnt = static_cast<std::uint32_t>(program.size());
  load.license = reinterpret_cast<std::uint64_t>("GPL");
  program_ = UniqueFd(bpf(BPF_PROG_LOAD, load));
  if (!program_.is_open()) return;
  bpf_attr attach = {};
  attach.link_create.prog_fd = static_cast<std::uint32_t>(program_.get());
  attach.link_create.target_ifindex = ::if_nametoindex(interface);
  attach.link_create.attach_type = BPF_XDP;
  attach.link_create.flags = XDP_FLAGS_SKB_MODE;
  link_ = UniqueFd(bpf(BPF_LINK_CREATE, attach));
}

}  // namespace zenith
