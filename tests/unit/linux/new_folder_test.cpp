#include "platform/linux/new_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(NewFolder, IsMadeWithItsParentsAndFilledWithNewFiles) {
  const tools::TemporaryFolder folder;
  const auto made = NewFolder::make(folder.path() / "deep" / "rec/");
  ASSERT_TRUE(made.ok()) << made.error().message;
  const auto below = made->make_folder("below");
  ASSERT_TRUE(below.ok());
  ASSERT_TRUE(below->write_file("file", "text").ok());
  EXPECT_EQ(tools::read_text(folder.path() / "deep/rec/below/file"), "text");
  EXPECT_FALSE(below->write_file("file", "other").ok());
  EXPECT_EQ(tools::read_text(folder.path() / "deep/rec/below/file"), "text");
  EXPECT_FALSE(made->make_folder("below").ok());
}

TEST(NewFolder, WhatIsThereAlreadyIsNone) {
  const tools::TemporaryFolder folder;
  fs::create_directory(folder.path() / "empty");
  fs::create_directory_symlink(folder.path() / "empty", folder.path() / "link");
  for (const char* name : {"empty", "link"}) {
    const auto made = NewFolder::make(folder.path() / name);
    ASSERT_FALSE(made.ok()) << name;
    EXPECT_THAT(made.error().message, HasSubstr("EEXIST"));
  }
}

TEST(NewFolder, NoNameLeadsOutOfIt) {
  const tools::TemporaryFolder folder;
  const auto made = NewFolder::make(folder.path() / "rec");
  ASSERT_TRUE(made.ok());
  const std::string victim = (folder.path() / "victim").string();
  tools::write_text(victim, "data");
  for (const std::string& name :
       {victim, std::string("../victim"), std::string(".."), std::string("."), std::string(),
        victim + std::string("\0\n.log", 6)}) {
    EXPECT_FALSE(made->write_file(name, "x").ok()) << name;
    EXPECT_FALSE(made->make_folder(name).ok()) << name;
  }
  EXPECT_EQ(tools::read_text(victim), "data");
}

// Somebody who may change the folder above exchanges it for a link while files are being made.
TEST(NewFolder, FilesAreMadeInTheFolderThatWasMadeWhateverItsPathLeadsTo) {
  const tools::TemporaryFolder folder;
  const tools::TemporaryFolder theirs;
  const auto made = NewFolder::make(folder.path() / "rec");
  ASSERT_TRUE(made.ok());
  fs::rename(folder.path() / "rec", folder.path() / "away");
  fs::create_directory_symlink(theirs.path(), folder.path() / "rec");
  ASSERT_TRUE(made->write_file("file", "text").ok());
  EXPECT_EQ(tools::entries(theirs.path()), 0u);
  EXPECT_EQ(tools::read_text(folder.path() / "away" / "file"), "text");
}

TEST(NewFolder, ALinkInThePlaceOfAFileIsNotFollowed) {
  const tools::TemporaryFolder folder;
  const auto made = NewFolder::make(folder.path() / "rec");
  ASSERT_TRUE(made.ok());
  const fs::path victim = folder.path() / "victim";
  tools::write_text(victim, "data");
  fs::create_symlink(victim, folder.path() / "rec" / "can0.log");
  EXPECT_FALSE(made->create_file("can0.log").ok());
  EXPECT_EQ(tools::read_text(victim), "data");
}

}  // namespace
}  // namespace zenith
