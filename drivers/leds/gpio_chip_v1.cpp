// libgpiod 1.x (Debian 12).

#include <gpiod.h>

#include <cerrno>

#include "drivers/leds/gpio_chip.h"
#include "drivers/leds/gpio_error.h"

namespace zenith {
namespace {

struct CloseChip {
  void operator()(gpiod_chip* chip) const { gpiod_chip_close(chip); }
};
using Chip = std::unique_ptr<gpiod_chip, CloseChip>;

std::string text_or_empty(const char* text) {
  return text == nullptr ? std::string() : std::string(text);
}

class Output : public GpioOutput {
 public:
  // Takes a requested line of the chip.
  Output(Chip chip, gpiod_line* line, GpioPlace place)
      : chip_(std::move(chip)), line_(line), place_(std::move(place)) {}
  ~Output() override {
    gpiod_line_set_value(line_, 0);
    gpiod_line_release(line_);
  }

  Status set(bool active) override {
    if (gpiod_line_set_value(line_, active ? 1 : 0) == 0) return {};
    return gpio_line_error(place_, errno);
  }

 private:
  Chip chip_;  // the line is a part of it
  gpiod_line* line_;
  const GpioPlace place_;
};

}  // namespace

std::string gpio_library() {
  return std::string("libgpiod ") + gpiod_version_string();
}

Result<GpioChipInfo> read_gpio_chip(const std::string& path) {
  const Chip chip(gpiod_chip_open(path.c_str()));
  if (chip == nullptr) return gpio_chip_error(path, errno);
  GpioChipInfo info;
  info.path = path;
  info.name = text_or_empty(gpiod_chip_name(chip.get()));
  info.label = text_or_empty(gpiod_chip_label(chip.get()));
  const unsigned count = gpiod_chip_num_lines(chip.get());
  for (unsigned offset = 0; offset < count; ++offset) {
    gpiod_line* line = gpiod_chip_get_line(chip.get(), offset);
    if (line == nullptr) return gpio_line_error({path, offset}, errno);
    info.lines.push_back({text_or_empty(gpiod_line_name(line)),
                          text_or_empty(gpiod_line_consumer(line)), gpiod_line_is_used(line)});
  }
  return info;
}

Result<std::unique_ptr<GpioOutput>> request_gpio_output(const GpioPlace& place, bool active_low,
                                                        const std::string& consumer) {
  Chip chip(gpiod_chip_open(place.chip_path.c_str()));
  if (chip == nullptr) return gpio_chip_error(place.chip_path, errno);
  gpiod_line* line = gpiod_chip_get_line(chip.get(), place.offset);
  if (line == nullptr) return gpio_line_error(place, errno);
  gpiod_line_request_config config = {};
  config.consumer = consumer.c_str();
  config.request_type = GPIOD_LINE_REQUEST_DIRECTION_OUTPUT;
  config.flags = active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  if (gpiod_line_request(line, &config, 0) != 0) return gpio_line_error(place, errno);
  return std::unique_ptr<GpioOutput>(new Output(std::move(chip), line, place));
}

}  // namespace zenith
