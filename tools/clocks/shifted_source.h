#pragma once
// A source on another clock.

#include <memory>
#include <utility>

#include "platform/recording/source.h"
#include "tools/clocks/alignment.h"

namespace zenith::tools {

class ShiftedSource : public Source {
 public:
  ShiftedSource(std::unique_ptr<Source> source, ClockShift shift)
      : source_(std::move(source)), shift_(std::move(shift)) {}

  const std::string& name() const override { return source_->name(); }
  const RobotConfig& config() const override { return source_->config(); }
  int frame_count() const override { return source_->frame_count(); }

  Result<bool> next(SourceFrame& frame) override {
    const auto more = source_->next(frame);
    if (!more || !*more) return more;
    frame.stamp = shift_.of(frame.stamp);
    for (WheelSample& sample : frame.wheels) sample.stamp = shift_.of(sample.stamp);
    return true;
  }

 private:
  std::unique_ptr<Source> source_;
  ClockShift shift_;
};

}  // namespace zenith::tools
