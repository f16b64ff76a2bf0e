#include "platform/daemon/tap/tap_server.h"

#include <sys/socket.h>
#include <sys/stat.h>

#include <array>
#include <filesystem>
#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/linux/clock.h"
#include "platform/linux/local_socket.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith::tap {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 200;

struct Message {
  MessageType type = MessageType::kBusy;
  std::vector<std::uint8_t> fields;
};

// A recorder that the test reads for by hand.
class Reader {
 public:
  explicit Reader(const std::string& path) {
    LocalConnection connection = connect_local(path, SOCK_STREAM);
    EXPECT_TRUE(connection.is_open()) << connection.why;
    fd_ = std::move(connection.fd);
  }
  // What has come until now.
  std::vector<Message> messages() {
    std::array<std::uint8_t, 65536> part;
    ssize_t got = 0;
    while ((got = ::recv(fd_.get(), part.data(), part.size(), MSG_DONTWAIT)) > 0) {
      bytes_.insert(bytes_.end(), part.begin(), part.begin() + got);
    }
    hung_up_ = got == 0;
    std::vector<Message> all;
    while (bytes_.size() >= kHeaderBytes) {
      const auto header = read_header(std::span(bytes_).first<kHeaderBytes>());
      EXPECT_TRUE(header.ok());
      if (!header.ok() || bytes_.size() < kHeaderBytes + header->length) break;
      const auto begin = bytes_.begin() + kHeaderBytes;
      all.push_back({header->type, {begin, begin + header->length}});
      bytes_.erase(bytes_.begin(), begin + header->length);
    }
    return all;
  }
  bool hung_up() const { return hung_up_; }
  void ask_end() { ::shutdown(fd_.get(), SHUT_WR); }

 private:
  UniqueFd fd_;
  std::vector<std::uint8_t> bytes_;
  bool hung_up_ = false;
};

class TapServerTest : public testing::Test {
 protected:
  void SetUp() override {
    Hello hello;
    hello.robot = "ada";
    hello.can_interface = "can0";
    server_ = std::make_unique<TapServer>(tap_, hello);
    const Status opened = server_->open(path_);
    ASSERT_TRUE(opened.ok()) << opened.error().message;
  }
  void turn(int times = 10) {
    for (int i = 0; i < times; ++i) server_->turn({1'000'000});
  }
  // Those who connect are taken in one after the other, with pauses.
  void turn_until(bool recording) {
    for (int i = 0; i < 2000 && server_->recording() != recording; ++i) turn(1);
    ASSERT_EQ(server_->recording(), recording);
  }
  void add_frame(int number) {
    pixels_.assign(static_cast<std::size_t>(kWidth) * kHeight, static_cast<std::uint8_t>(number));
    CameraFrame frame;
    frame.stamp = {number};
    frame.luma = {pixels_.data(), kWidth, kHeight, kWidth};
    tap_.add(frame);
  }

  tools::TemporaryFolder folder_;
  const std::string path_ = (folder_.path() / "record.sock").string();
  Tap tap_{kWidth, kHeight, 4};
  std::unique_ptr<TapServer> server_;
  std::vector<std::uint8_t> pixels_;
};

TEST_F(TapServerTest, TellsEverythingInOrderAndHowItEnded) {
  Reader reader(path_);
  turn_until(true);
  CanFrame can;
  can.id = 0x311;
  tap_.add(can);
  tap_.add(TappedPose{{5}, {1, 2, 3}});
  for (int i = 1; i <= 3; ++i) {
    add_frame(i);
    turn();
  }
  reader.ask_end();
  std::vector<Message> all;
  for (int i = 0; i < 1000 && server_->recording(); ++i) {
    turn(1);
    for (Message& message : reader.messages()) all.push_back(std::move(message));
  }
  for (Message& message : reader.messages()) all.push_back(std::move(message));
  EXPECT_TRUE(reader.hung_up());
  ASSERT_EQ(all.size(), 7u);
  EXPECT_EQ(all[0].type, MessageType::kHello);
  EXPECT_EQ(read_hello(all[0].fields)->robot, "ada");
  EXPECT_EQ(all[1].type, MessageType::kCan);
  EXPECT_EQ(all[2].type, MessageType::kPose);
  for (int i = 1; i <= 3; ++i) {
    std::span<const std::uint8_t> pixels;
    const auto head = read_frame(all[static_cast<std::size_t>(i + 2)].fields, pixels);
    ASSERT_TRUE(head.ok());
    EXPECT_EQ(head->stamp.ns, i);
    EXPECT_EQ(pixels.back(), i);
  }
  const auto end = read_end(all[6].fields);
  ASSERT_TRUE(end.ok());
  EXPECT_EQ(end->frames, 3u);
  EXPECT_EQ(end->frames_dropped, 0u);
  EXPECT_EQ(end->can, 1u);
  EXPECT_EQ(end->poses, 1u);
  EXPECT_EQ(end->why, "as asked");
}

TEST_F(TapServerTest, ASlowReaderLosesFramesAndIsToldHowMany) {
  Reader reader(path_);
  turn_until(true);
  constexpr int kFrames = 60;  // more than socket and slots hold
  for (int i = 0; i < kFrames; ++i) {
    add_frame(i);
    turn(2);
  }
  EXPECT_GT(tap_.drops().frames, 10u);
  reader.ask_end();
  std::uint64_t frames = 0;
  End end;
  for (int i = 0; i < 2000 && !reader.hung_up(); ++i) {
    for (const Message& message : reader.messages()) {
      frames += message.type == MessageType::kFrame;
      if (message.type == MessageType::kEnd) end = *read_end(message.fields);
    }
    turn(1);
  }
  EXPECT_EQ(end.frames, frames);
  EXPECT_EQ(end.frames + end.frames_dropped, static_cast<std::uint64_t>(kFrames));
}

TEST_F(TapServerTest, AReaderThatLeavesInTheMiddleOfAFrameTakesNoSlotAlong) {
  for (int round = 0; round < 8; ++round) {  // twice as many as slots
    auto reader = std::make_unique<Reader>(path_);
    turn_until(true);
    for (int i = 0; i < 12; ++i) {
      add_frame(i);
      turn(2);
    }
    reader.reset();
    turn_until(false);
  }
  tap_.start();
  for (int i = 0; i < 4; ++i) add_frame(i);
  EXPECT_EQ(tap_.drops().frames, 0u);
}

TEST_F(TapServerTest, ASecondRecorderIsTurnedAway) {
  Reader first(path_);
  turn_until(true);
  Reader second(path_);
  std::vector<Message> said;
  for (int i = 0; i < 1000 && !second.hung_up(); ++i) {
    turn(1);
    for (Message& message : second.messages()) said.push_back(std::move(message));
  }
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].type, MessageType::kBusy);
  EXPECT_TRUE(server_->recording()) << "the first goes on";
}

TEST_F(TapServerTest, OneThatTalksInsteadOfListeningIsEnded) {
  const UniqueFd talker = connect_local(path_, SOCK_STREAM).fd;
  turn_until(true);
  ASSERT_EQ(::send(talker.get(), "GET /", 5, MSG_NOSIGNAL), 5);
  turn_until(false);
}

TEST_F(TapServerTest, ManyThatConnectAreTakenInSlowly) {
  std::vector<UniqueFd> many;
  const Time begin = monotonic_now();
  int rounds = 0;
  for (; monotonic_now() < begin + Duration{300'000'000}; ++rounds) {
    many.push_back(connect_local(path_, SOCK_STREAM).fd);
    turn(1);
    if (many.size() > 20) many.clear();
  }
  many.clear();
  turn_until(false);
  // Each round waited for its turn: no tight loop, however eager those outside are.
  EXPECT_LT(rounds, 1000);
}

TEST_F(TapServerTest, OnlyTheOwnerMayOpenTheSocket) {
  struct stat file = {};
  ASSERT_EQ(::stat(path_.c_str(), &file), 0);
  EXPECT_EQ(file.st_mode & 0777, 0600u);
  server_->close();
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(TapServerTest, TheDaemonsEndIsToldToTheRecorder) {
  Reader reader(path_);
  turn_until(true);
  server_->run(std::atomic<bool>(true));
  EXPECT_FALSE(server_->recording());
  const auto all = reader.messages();
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(all.back().type, MessageType::kEnd);
  EXPECT_EQ(read_end(all.back().fields)->why, "the daemon ends");
}

}  // namespace
}  // namespace zenith::tap
