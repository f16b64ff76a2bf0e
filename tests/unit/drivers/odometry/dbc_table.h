#pragma once
// Reads what tests/support/dbc_table.mjs prints, and compares it with this reader: the same
// signals, the same values.

#include <cmath>
#include <cstdlib>
#include <istream>
#include <optional>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "drivers/odometry/dbc.h"
#include "drivers/odometry/dbc_signal.h"

namespace zenith {

struct DbcTableCounts {
  int signals = 0;
  int values = 0;
};

class DbcTable {
 public:
  // The lines up to the next file, which is left in `line`.
  void compare(std::istream& in, const DbcFile& file, std::string& line) {
    CanFrame frame;
    while (std::getline(in, line) && !line.starts_with("file ")) {
      std::istringstream words(line);
      std::string what;
      words >> what;
      if (what == "signal") signal(words, file);
      if (what == "frame") frame = read_frame(words);
      if (what == "value") value(words, file, frame);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
  const DbcTableCounts& counts() const { return counts_; }

 private:
  // Those whose names are twice in a message, or that classic frames cannot hold, are not compared.
  static std::optional<DbcEntry> find(const DbcFile& file, const std::string& message,
                                      const std::string& name) {
    auto found = find_signal(file, message + "." + name);
    if (found.ok()) return *found;
    return std::nullopt;
  }

  void signal(std::istringstream& words, const DbcFile& file) {
    std::string message, name, kind, mux;
    std::uint32_t id = 0;
    std::uint32_t start = 0;
    std::uint32_t length = 0;
    int extended = 0;
    int motorola = 0;
    double scale = 0.0;
    double offset = 0.0;
    words >> message >> name >> id >> extended >> start >> length >> motorola >> kind >> scale >>
        offset >> mux;
    ASSERT_TRUE(words) << words.str();
    const auto entry = find(file, message, name);
    if (!entry) return;
    const DbcSignal& s = entry->signal;
    EXPECT_EQ(s.id, (CanId{id, extended == 1})) << words.str();
    EXPECT_EQ(s.start_bit, start) << words.str();
    EXPECT_EQ(s.bit_length, length) << words.str();
    EXPECT_EQ(s.motorola, motorola == 1) << words.str();
    EXPECT_EQ(std::string("usfd").find(kind), static_cast<std::size_t>(s.value)) << words.str();
    EXPECT_EQ(s.scale, scale) << words.str();
    EXPECT_EQ(s.offset, offset) << words.str();
    EXPECT_EQ(entry->multiplexing, mux == "-" ? "" : mux) << words.str();
    ++counts_.signals;
  }

  static CanFrame read_frame(std::istringstream& words) {
    CanFrame frame;
    int extended = 0;
    std::string hex;
    words >> frame.id >> extended >> hex;
    frame.extended = extended == 1;
    for (; frame.length < 8 && 2U * frame.length + 2 <= hex.size(); ++frame.length) {
      frame.data[frame.length] = static_cast<std::uint8_t>(
          std::strtoul(hex.substr(2U * frame.length, 2).c_str(), nullptr, 16));
    }
    return frame;
  }

  void value(std::istringstream& words, const DbcFile& file, const CanFrame& frame) {
    std::string message, name, number;
    std::uint64_t raw = 0;
    words >> message >> name >> raw >> number;
    ASSERT_FALSE(words.fail()) << words.str();
    const auto entry = find(file, message, name);
    if (!entry) return;
    ASSERT_EQ(entry->signal.id, id_of(frame)) << words.str();
    ASSERT_LE(bytes_needed(entry->signal, entry->conditions), frame.length) << words.str();
    EXPECT_TRUE(holds(entry->conditions, frame)) << words.str();
    EXPECT_EQ(read_raw(entry->signal, frame), raw) << words.str();
    const double expected = std::strtod(number.c_str(), nullptr);
    const double got = physical_of(entry->signal, raw);
    EXPECT_TRUE(got == expected || (std::isnan(got) && std::isnan(expected)))
        << words.str() << ", found " << got;
    ++counts_.values;
  }

  DbcTableCounts counts_;
};

}  // namespace zenith
