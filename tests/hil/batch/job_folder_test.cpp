// SPDX-License-Identifier: Apache-2.0
#include "hil/batch/job_folder.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"
#include "tests/hil/batch/small_jobs.h"

namespace kerfbench::batch {
namespace {

namespace fs = std::filesystem;
using State = JobFolder::State;
using testing::HasSubstr;

/// A job that has ended, and whose folder is whole.
class RecordedJob : public testing::Test {
 protected:
  RecordedJob() {
    fs::create_directories(job_.folder / "deep");
    put("deep/verdict.json", "{}");
    put(kJobLog, "a line\n");
    fs::create_directory_symlink("deep", job_.folder / "latest");
    recordEnd(job_, {JobEnd::How::kExited, 4, 1.5});
  }
  void put(const std::string& name, const std::string& text) const {
    std::ofstream(job_.folder / name, std::ios::binary) << text;
  }
  [[nodiscard]] std::string record() const { return base::contentOf(job_.folder / kJobRecord); }
  /// What is wrong, of a folder that must be taken for damaged.
  [[nodiscard]] std::string damage() const {
    const JobFolder folder = lookAt(job_);
    EXPECT_EQ(folder.state, State::kDamaged);
    EXPECT_FALSE(folder.end.has_value());
    EXPECT_THAT(folder.why, HasSubstr(job_.folder.string()));
    return folder.why;
  }

  SmallJobs jobs_;
  const Job job_ = jobs_.job("a", "true");
};

TEST_F(RecordedJob, IsWholeAsItWasLeft) {
  const JobFolder folder = lookAt(job_);
  ASSERT_EQ(folder.state, State::kWhole) << folder.why;
  EXPECT_TRUE(folder.end->exitedWith(4));
  EXPECT_EQ(folder.end->wall_s, 1.5);
}

TEST_F(RecordedJob, HasNoResultOfOtherInputs) {
  Job other = job_;
  other.inputs += ", changed";
  EXPECT_EQ(lookAt(other).state, State::kOtherInputs);
}

TEST_F(RecordedJob, IsDamagedByAnyFileChangedMissingOrAdded) {
  put("deep/verdict.json", "[]");  // As long as before.
  EXPECT_THAT(damage(), HasSubstr("'deep/verdict.json' was changed"));
  put("deep/verdict.json", "{}");
  EXPECT_EQ(lookAt(job_).state, State::kWhole);
  put("deep/more", "");
  EXPECT_THAT(damage(), HasSubstr("'deep/more' was added"));
  fs::remove(job_.folder / "deep/more");
  fs::remove(job_.folder / "latest");
  EXPECT_THAT(damage(), HasSubstr("'latest' is missing"));
  fs::create_directory_symlink("elsewhere", job_.folder / "latest");
  EXPECT_THAT(damage(), HasSubstr("'latest' was changed"));
}

TEST_F(RecordedJob, IsDamagedByABrokenRecord) {
  const std::string whole = record();
  for (const std::string& broken :
       {std::string(), whole.substr(0, whole.size() / 2), std::string("[]"),
        base::replaced(whole, "\"exited\"", "\"vanished\""), base::replaced(whole, "\"code\"", "\"kode\"")}) {
    put(kJobRecord, broken);
    EXPECT_THAT(damage(), HasSubstr(kJobRecord)) << broken;
  }
}

TEST_F(RecordedJob, OfAnotherVersionIsLeftAlone) {
  put(kJobRecord, base::replaced(record(), "\"schema_version\": 1", "\"schema_version\": 2"));
  const JobFolder folder = lookAt(job_);
  EXPECT_EQ(folder.state, State::kForeign);
  EXPECT_THAT(folder.why, HasSubstr("is of schema_version 2, and this bench reads 1"));
}

TEST(JobFolder, WithoutARecordIsNoResult) {
  const SmallJobs jobs;
  const Job job = jobs.job("a", "true");
  EXPECT_EQ(lookAt(job).state, State::kAbsent);
  fs::create_directories(job.folder);
  EXPECT_EQ(lookAt(job).state, State::kAbsent);
  std::ofstream(job.folder / "verdict.json") << "{}";
  EXPECT_EQ(lookAt(job).state, State::kForeign);
  std::ofstream(job.folder / kJobLog) << "";
  EXPECT_EQ(lookAt(job).state, State::kUnfinished);
  fs::remove_all(job.folder);
  std::ofstream(job.folder) << "a file";
  EXPECT_EQ(lookAt(job).state, State::kForeign);
}

TEST(JobFolder, IsSetAsideUnderTheNextFreeNumber) {
  const SmallJobs jobs;
  const fs::path folder = jobs.folder() / "a";
  EXPECT_EQ(asideOf(folder), 0);
  for (const char* name : {"a.1", "a.2"}) {
    fs::create_directory(folder);
    EXPECT_EQ(setAside(folder), jobs.folder() / name);
    EXPECT_TRUE(fs::is_directory(jobs.folder() / name));
    EXPECT_FALSE(fs::exists(folder));
  }
  EXPECT_EQ(asideOf(folder), 2);
}

TEST(FolderLock, RefusesASecondWriterAndSaysWhoTheFirstIs) {
  const SmallJobs jobs;
  {
    const FolderLock first(jobs.folder());
    try {
      const FolderLock second(jobs.folder() / ".");
      FAIL() << "two writers";
    } catch (const base::InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr(jobs.folder().string()));
      EXPECT_THAT(e.what(), HasSubstr("process " + std::to_string(::getpid())));
    }
  }
  EXPECT_NO_THROW(FolderLock(jobs.folder()));
  EXPECT_THROW(FolderLock(jobs.folder() / "nothing"), std::system_error);
}

}  // namespace
}  // namespace kerfbench::batch
