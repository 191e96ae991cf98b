#include "experiments/atomic_file.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace raymeter {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public testing::Test {
protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "raymeter-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string path(const char* name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::string text(const char* name) const {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::ptrdiff_t entries() const { return std::distance(fs::directory_iterator(folder_), {}); }

  fs::path folder_;
};

TEST_F(AtomicFileTest, AppearsWholeOrNotAtAll) {
  {
    AtomicFile lost(path("a"));
    lost.write("half");
  }
  EXPECT_EQ(entries(), 0);
  for (const char* content : {"first", "second"}) {
    AtomicFile file(path("a"));
    file.write(content);
    file.commit();
    EXPECT_EQ(text("a"), content);
    EXPECT_EQ(entries(), 1);
  }
}

TEST_F(AtomicFileTest, LinksStayLinks) {
  std::ofstream(folder_ / "file") << "old";
  fs::create_symlink("file", folder_ / "link");
  AtomicFile file(path("link"));
  file.write("new");
  file.commit();
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(text("file"), "new");
}

TEST_F(AtomicFileTest, DevicesStayDevices) {
  fs::create_symlink("/dev/full", folder_ / "full");
  fs::create_symlink("/dev/null", folder_ / "null");
  AtomicFile full(path("full"));
  EXPECT_THROW(full.write("much"), std::runtime_error);
  AtomicFile null(path("null"));
  null.write("much");
  null.commit();
  EXPECT_EQ(entries(), 2);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(AtomicFileTest, RefusesFolders) {
  EXPECT_THROW(AtomicFile file(folder_.string()), Error);
  EXPECT_THROW(AtomicFile file(path("absent/file")), Error);
  EXPECT_EQ(entries(), 0);
}

}  // namespace
}  // namespace raymeter
