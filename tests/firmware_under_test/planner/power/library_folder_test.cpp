// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/power/library_folder.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/power/model.h"
#include "libraries.h"

namespace kerfbench::planner {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A folder for a library, removed in the end.
class FolderOfLibrary : public testing::Test {
 protected:
  FolderOfLibrary() { fs::create_directories(path_); }
  ~FolderOfLibrary() override { fs::remove_all(path_); }
  FolderOfLibrary(const FolderOfLibrary&) = delete;
  FolderOfLibrary& operator=(const FolderOfLibrary&) = delete;

  void put(const std::string& file, const std::string& text) const {
    std::ofstream(path_ / file, std::ios::binary) << text;
  }
  /// Puts a material with some keys and a last depth.
  void putMaterial(const std::string& file, const std::string& keys, double deepest_mm = 1.0) const {
    put(file,
        fmt::format("version: 1\nkind: material\n{}units: {{power_per_area: J/mm2, depth: mm}}\npoints:\n"
                    "  - {{power_per_area: 0, depth: 0}}\n  - {{power_per_area: 4, depth: {}}}\n",
                    keys, deepest_mm));
  }
  [[nodiscard]] std::string at(const std::string& place) const { return (path_ / place).string(); }
  [[nodiscard]] LibraryFolder library() const { return LibraryFolder(path_); }
  [[nodiscard]] std::string refusal(EntryKind kind, const std::string& wanted) const {
    try {
      (void)library().fileOf(kind, wanted);
    } catch (const PowerError& error) {
      return error.what();
    }
    return {};
  }

  fs::path path_ = fs::temp_directory_path() / fmt::format("planner-library-{}", ::getpid());
};

TEST(ShippedLibrary, IsSoundAndKeepsItsNumbers) {
  const LibraryFolder library(test::kPowerFolder);
  EXPECT_THAT(library.faults(), IsEmpty());
  const auto nameOf = [&](const fs::path& file) { return file.filename().string(); };
  EXPECT_EQ(nameOf(library.fileOf(EntryKind::kMaterial, "1")), "mild-steel.yaml");
  EXPECT_EQ(nameOf(library.fileOf(EntryKind::kMaterial, "2")), "carton-board-0.4.yaml");
  EXPECT_EQ(nameOf(library.fileOf(EntryKind::kLaser, "1")), "co2-tube-80w.yaml");
  EXPECT_EQ(nameOf(library.fileOf(EntryKind::kMaterial, " Mild Steel ")), "mild-steel.yaml");
  EXPECT_THAT(libraryTable(library), HasSubstr("0 … 15 J/mm2 give 0 … 0.48 mm"));
  for (const LibraryEntry& entry : library.entries()) {
    const std::string page = entryPage(entry);
    EXPECT_THAT(page, AllOf(HasSubstr("source  "), HasSubstr("range   "), HasSubstr(entry.name)));
  }
}

TEST_F(FolderOfLibrary, SortsMaterialsAndLasersByNumber) {
  putMaterial("a.yaml", "number: 12\nname: twelve\nsource: s\n");
  putMaterial("b.yml", "number: 7\nname: seven\nsource: s\n");
  put("c.yaml",
      "version: 1\nkind: laser\nnumber: 7\nname: tube\nsource: s\nunits: {control: V, power: W}\n"
      "full_control: 5\npoints:\n  - {control: 0, power: 1}\n  - {control: 5, power: 9}\n");
  put("notes.txt", "no entry");
  const LibraryFolder all = library();
  ASSERT_EQ(all.entries().size(), 3U);
  EXPECT_EQ(all.entries()[0].name, "seven");
  EXPECT_EQ(all.entries()[1].name, "twelve");
  EXPECT_EQ(all.entries()[2].laser->number, 7);
  EXPECT_THAT(all.faults(), IsEmpty());
}

TEST_F(FolderOfLibrary, FindsWhatIsThereTwiceWithBothPlaces) {
  putMaterial("a.yaml", "number: 3\nname: board\nsource: s\n");
  putMaterial("b.yaml", "name: Board\nnumber: 3\nsource: s\n");
  EXPECT_THAT(library().faults(),
              ElementsAre(at("b.yaml") + ":4: number: 3 is that of " + at("a.yaml") + ":3 already",
                          at("b.yaml") + ":3: name: 'Board' is that of " + at("a.yaml") + ":4 already"));
  EXPECT_THAT(refusal(EntryKind::kMaterial, "3"),
              AllOf(HasSubstr("twice"), HasSubstr("a.yaml"), HasSubstr("b.yaml")));
}

TEST_F(FolderOfLibrary, FindsWhatIsMissingOrOutOfRangeWithFileAndLine) {
  putMaterial("a.yaml", "name: anonymous\n");
  put("b.yaml",
      "version: 1\nkind: material\nnumber: 0\nname: b\nsource: s\npoints:\n"
      "  - {power_per_area: 0, depth: 0}\n  - {power_per_area: 3, depth: 2}\n"
      "  - {power_per_area: 2, depth: 3}\n  - {power_per_area: 9e9, depth: 4}\n");
  put("c.yaml",
      "version: 1\nkind: laser\nnumber: 1\nname: c\nsource: s\nunits: {control: '%', power: W}\n"
      "full_control: 120\npoints:\n  - {control: 0, power: 1}\n  - {control: 120, power: 9}\n");
  put("d.yaml", "kind: spoon\n");
  put("e.yaml", "{");
  const std::vector<std::string> faults = library().faults();
  EXPECT_THAT(faults, Contains(HasSubstr("a.yaml:1: number: is missing")));
  EXPECT_THAT(faults, Contains(HasSubstr("a.yaml:1: source: is missing")));
  EXPECT_THAT(faults, Contains(HasSubstr("b.yaml:3: number: 0 is outside")));
  EXPECT_THAT(faults, Contains(HasSubstr("b.yaml:1: units.power_per_area: missing")));
  EXPECT_THAT(faults, Contains(HasSubstr("b.yaml:9: points[2].power_per_area: 2 does not rise above 3")));
  EXPECT_THAT(faults, Contains(HasSubstr("b.yaml:10: points[3].power_per_area: 9000000000 is outside")));
  EXPECT_THAT(faults, Contains(HasSubstr("c.yaml:10: points[1].control: 120 is outside")));
  EXPECT_THAT(faults, Contains(HasSubstr("d.yaml:1: kind: 'spoon' is neither material nor laser")));
  EXPECT_THAT(faults, Contains(HasSubstr("e.yaml")));
}

TEST_F(FolderOfLibrary, SaysWhatIsThereAndWhatWouldDo) {
  putMaterial("a.yaml", "number: 1\nname: thin\nsource: s\n", 0.3);
  putMaterial("b.yaml", "number: 2\nname: thick\nsource: s\n", 3.0);
  EXPECT_THAT(refusal(EntryKind::kMaterial, "3"),
              HasSubstr("no material '3'; there are 1 (thin), 2 (thick)"));
  EXPECT_THAT(refusal(EntryKind::kLaser, "1"), HasSubstr("there are none"));
  EXPECT_EQ(library().materialsFor(2.0), "2 (thick) to 3 mm");
  EXPECT_EQ(library().materialsFor(5.0), "");
  try {
    const PowerModel model(readMaterial(at("a.yaml")), test::tube(),
                           {.depth_mm = 2.0,
                            .given_by = GivenBy::kCommandLine,
                            .deeper_materials = library().materialsFor(2.0)});
    FAIL();
  } catch (const PowerError& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("--depth: 2 mm cannot be had in thin"), HasSubstr("0.3 mm is the greatest"),
                      HasSubstr("the library has it in material 2 (thick) to 3 mm")));
  }
  EXPECT_THROW(LibraryFolder(path_ / "nowhere"), PowerError);
}

TEST(LibraryNames, AreNotFiles) {
  for (const char* name : {"3", "mild steel", "a.b"}) EXPECT_TRUE(isLibraryName(name)) << name;
  for (const char* file : {"", "steel.yaml", "steel.YML", "./steel", "../3"})
    EXPECT_FALSE(isLibraryName(file)) << file;
}

}  // namespace
}  // namespace kerfbench::planner
