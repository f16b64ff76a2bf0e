#include "platform/daemon/frozen_picture.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

namespace zenith {

void FrozenPicture::note_wheels(const WheelSample& sample) {
  wheels_ = sample;
  if (!wheels_at_new_) wheels_at_new_ = sample;
  moved_m_ = std::max({moved_m_, std::abs(sample.left_m - wheels_at_new_->left_m),
                       std::abs(sample.right_m - wheels_at_new_->right_m)});
}

FrozenPicture::Verdict FrozenPicture::judge(const ImageView& picture) {
  const Digest digest = digest_of(picture);
  if (!known_ || digest.value != digest_ || digest.informative < kMinInformative) {
    known_ = true;
    digest_ = digest.value;
    repeats_ = 0;
    moved_m_ = 0.0;
    wheels_at_new_ = wheels_;
    return Verdict::kNew;
  }
  repeats_ = std::min(repeats_ + 1, kFrozenRepeats);
  if (moved_m_ <= kStale_m) return Verdict::kRepeated;
  const bool for_long = repeats_ >= kFrozenRepeats && moved_m_ > kFrozen_m;
  return for_long ? Verdict::kFrozen : Verdict::kStale;
}

// FNV-1a over words of eight bytes, with a turn so that high bits count as low ones do.
FrozenPicture::Digest FrozenPicture::digest_of(const ImageView& picture) {
  constexpr std::uint64_t kPrime = 0x100000001B3U;
  Digest digest = {0xCBF29CE484222325U, 0};
  const auto mix = [&](std::uint64_t word) {
    const std::uint64_t mixed = (digest.value ^ word) * kPrime;
    digest.value = mixed << 23U | mixed >> 41U;
  };
  const auto width = static_cast<std::size_t>(std::max(picture.width, 0));
  for (int i = 0; i < kRows && picture.height > 0; ++i) {
    const std::uint8_t* row = picture.row((2 * i + 1) * picture.height / (2 * kRows));
    std::size_t u = 0;
    for (; u + sizeof(std::uint64_t) <= width; u += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, row + u, sizeof word);
      mix(word);
    }
    for (; u < width; ++u) mix(row[u]);
    digest.informative += static_cast<int>(std::count_if(row, row + width, [](std::uint8_t grey) {
      return grey >= kDarkest && grey <= kBrightest;
    }));
  }
  return digest;
}

}  // namespace zenith
