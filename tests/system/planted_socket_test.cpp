// Somebody on the same computer makes sockets where programs look for the daemon's.

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/linux/unique_fd.h"
#include "tests/system/process.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

using testing::HasSubstr;
using testing::Not;
using tools::read_text;
using tools::write_text;

constexpr double kLimit_s = 60.0;
constexpr uid_t kMallory = 12345;

class PlantedSocketTest : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  // Of another user, in a folder that only root may change.
  UniqueFd plant(const std::string& name, int type) {
    const std::string folder = path("run");
    std::filesystem::create_directory(folder);
    EXPECT_EQ(::chmod(folder_.path().c_str(), 0755), 0);
    EXPECT_EQ(::chown(folder.c_str(), kMallory, 0), 0);
    EXPECT_EQ(::seteuid(kMallory), 0);
    UniqueFd fd(::socket(AF_UNIX, type | SOCK_CLOEXEC, 0));
    sockaddr_un address = {};
    address.sun_family = AF_UNIX;
    const std::string at = folder + "/" + name;
    std::memcpy(address.sun_path, at.data(), at.size());
    EXPECT_EQ(::bind(fd.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(fd.get(), 4), 0);
    EXPECT_EQ(::seteuid(0), 0);
    EXPECT_EQ(::chown(folder.c_str(), 0, 0), 0);
    return fd;
  }
  // What a client says that looks for the daemon in `runtime`; "" is nowhere of its own.
  std::string say(std::vector<std::string> words, const std::string& runtime) {
    words.insert(words.begin(), ZENITH_TOOL);
    Process client(words, path("out.txt"), path("errors.txt"),
                   {{"XDG_RUNTIME_DIR", runtime}, {"RUNTIME_DIRECTORY", ""}});
    EXPECT_NE(client.wait(kLimit_s), -1) << "it waits for whoever listens there";
    return read_text(path("out.txt")) + read_text(path("errors.txt"));
  }

  tools::TemporaryFolder folder_;
};

TEST_F(PlantedSocketTest, NoClientLooksWhereAnybodyMayMakeOne) {
  EXPECT_THAT(say({"record", path("rec")}, ""), Not(HasSubstr("/tmp/record.sock")));
  EXPECT_THAT(say({"telemetry"}, ""), Not(HasSubstr("/tmp/telemetry.sock")));
}

TEST_F(PlantedSocketTest, NoClientTalksToAnotherUsersSocketAndSaysWhoseItIs) {
  if (::geteuid() != 0) GTEST_SKIP() << "SKIPPED: only root can act as another user";
  const UniqueFd telemetry = plant("telemetry.sock", SOCK_SEQPACKET);
  const UniqueFd record = plant("record.sock", SOCK_STREAM);
  const std::string run = path("run");
  for (const std::string& said :
       {say({"record", path("rec")}, run), say({"telemetry"}, run),
        say({"record", path("rec"), "--socket", run + "/record.sock"}, ""),
        say({"telemetry", run + "/telemetry.sock"}, "")}) {
    EXPECT_THAT(said, HasSubstr("the socket is one of user 12345"));
  }
  EXPECT_FALSE(std::filesystem::exists(path("rec")));
  write_text(path("zenith.toml"),
             "[camera]\ndriver = \"simulated\"\n[odometry]\ndriver = \"simulated\"\n");
  EXPECT_THAT(say({"doctor", "--config", path("zenith.toml")}, run),
              HasSubstr("the socket is one of user 12345"));
}

}  // namespace
}  // namespace zenith
