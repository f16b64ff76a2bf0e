// libgpiod 2.x (Debian 13).

#include <gpiod.h>

#include <cerrno>

#include "drivers/leds/gpio_chip.h"
#include "drivers/leds/gpio_error.h"

namespace zenith {
namespace {

struct Free {
  void operator()(gpiod_chip* chip) const { gpiod_chip_close(chip); }
  void operator()(gpiod_chip_info* info) const { gpiod_chip_info_free(info); }
  void operator()(gpiod_line_info* info) const { gpiod_line_info_free(info); }
  void operator()(gpiod_line_settings* settings) const { gpiod_line_settings_free(settings); }
  void operator()(gpiod_line_config* config) const { gpiod_line_config_free(config); }
  void operator()(gpiod_request_config* config) const { gpiod_request_config_free(config); }
  void operator()(gpiod_line_request* request) const { gpiod_line_request_release(request); }
};
template <typename T>
using Owned = std::unique_ptr<T, Free>;

std::string text_or_empty(const char* text) {
  return text == nullptr ? std::string() : std::string(text);
}

class Output : public GpioOutput {
 public:
  Output(Owned<gpiod_line_request> request, GpioPlace place)
      : request_(std::move(request)), place_(std::move(place)) {}
  ~Output() override {
    gpiod_line_request_set_value(request_.get(), place_.offset, GPIOD_LINE_VALUE_INACTIVE);
  }

  Status set(bool active) override {
    const gpiod_line_value value = active ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
    if (gpiod_line_request_set_value(request_.get(), place_.offset, value) == 0) return {};
    return gpio_line_error(place_, errno);
  }

 private:
  Owned<gpiod_line_request> request_;  // outlives the chip that it was made on
  const GpioPlace place_;
};

}  // namespace

std::string gpio_library() {
  return std::string("libgpiod ") + gpiod_api_version();
}

Result<GpioChipInfo> read_gpio_chip(const std::string& path) {
  const Owned<gpiod_chip> chip(gpiod_chip_open(path.c_str()));
  if (chip == nullptr) return gpio_chip_error(path, errno);
  const Owned<gpiod_chip_info> chip_info(gpiod_chip_get_info(chip.get()));
  if (chip_info == nullptr) return gpio_chip_error(path, errno);
  GpioChipInfo info;
  info.path = path;
  info.name = text_or_empty(gpiod_chip_info_get_name(chip_info.get()));
  info.label = text_or_empty(gpiod_chip_info_get_label(chip_info.get()));
  const auto count = static_cast<unsigned>(gpiod_chip_info_get_num_lines(chip_info.get()));
  for (unsigned offset = 0; offset < count; ++offset) {
    const Owned<gpiod_line_info> line(gpiod_chip_get_line_info(chip.get(), offset));
    if (line == nullptr) return gpio_line_error({path, offset}, errno);
    info.lines.push_back({text_or_empty(gpiod_line_info_get_name(line.get())),
                          text_or_empty(gpiod_line_info_get_consumer(line.get())),
                          gpiod_line_info_is_used(line.get())});
  }
  return info;
}

Result<std::unique_ptr<GpioOutput>> request_gpio_output(const GpioPlace& place, bool active_low,
                                                        const std::string& consumer) {
  const Owned<gpiod_chip> chip(gpiod_chip_open(place.chip_path.c_str()));
  if (chip == nullptr) return gpio_chip_error(place.chip_path, errno);
  const Owned<gpiod_line_settings> settings(gpiod_line_settings_new());
  const Owned<gpiod_line_config> lines(gpiod_line_config_new());
  const Owned<gpiod_request_config> config(gpiod_request_config_new());
  if (settings == nullptr || lines == nullptr || config == nullptr) {
    return gpio_line_error(place, ENOMEM);
  }
  gpiod_line_settings_set_active_low(settings.get(), active_low);
  if (gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT) != 0 ||
      gpiod_line_settings_set_output_value(settings.get(), GPIOD_LINE_VALUE_INACTIVE) != 0 ||
      gpiod_line_config_add_line_settings(lines.get(), &place.offset, 1, settings.get()) != 0) {
    return gpio_line_error(place, errno);
  }
  gpiod_request_config_set_consumer(config.get(), consumer.c_str());
  Owned<gpiod_line_request> request(
      gpiod_chip_request_lines(chip.get(), config.get(), lines.get()));
  if (request == nullptr) return gpio_line_error(place, errno);
  return std::unique_ptr<GpioOutput>(new Output(std::move(request), place));
}

}  // namespace zenith
