// SPDX-License-Identifier: Apache-2.0
// The page in a browser: no request, no script error, and sorting that works. Skipped where Chromium is not
// installed.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/hil/report/sample_report.h"

namespace kerfbench::report {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

bool hasChromium() { return std::system("command -v chromium >/dev/null 2>&1") == 0; }

struct Browsed {
  std::string dom;       ///< After the scripts have run.
  std::string messages;  ///< Lines that the page caused on the console.
};

/// Opens a page without any way to the network.
Browsed browse(const std::string& name, const std::string& html) {
  const fs::path folder = fs::path(KERFBENCH_BINARY_DIR) / "report-in-a-browser";
  fs::create_directories(folder);
  const fs::path page = folder / (name + ".html");
  const fs::path log = folder / (name + ".log");
  const fs::path dom = folder / (name + ".dom");
  std::ofstream(page, std::ios::binary) << html;
  const std::string command =
      "chromium --headless=new --no-sandbox --disable-gpu --disable-dev-shm-usage --no-first-run "
      "--disable-background-networking --disable-component-update --host-resolver-rules='MAP * ~NOTFOUND' "
      "--user-data-dir='" +
      (folder / (name + ".profile")).string() + "' --enable-logging=stderr --v=0 --dump-dom 'file://" +
      page.string() + "' >'" + dom.string() + "' 2>'" + log.string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  const auto textOf = [](const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(file), {}};
  };
  Browsed browsed{textOf(dom), {}};
  std::ifstream lines(log);
  for (std::string line; std::getline(lines, line);)
    if (line.find("CONSOLE") != std::string::npos) browsed.messages += line + "\n";
  return browsed;
}

TEST(InABrowser, ThePageAsksForNothingAndItsScriptWorks) {
  if (!hasChromium()) GTEST_SKIP() << "chromium is not installed: the page was not opened in a browser";
  const std::string html = test::htmlOf(test::reportOf(test::badRun()));
  const Browsed browsed = browse("report", html);
  EXPECT_EQ(browsed.messages, "");
  // The script has made the heads of tables buttons, and a filter for each.
  EXPECT_THAT(browsed.dom, HasSubstr("<button type=\"button\">Entity</button>"));
  EXPECT_THAT(browsed.dom, HasSubstr("aria-label=\"Filter the rows of this table\""));
}

TEST(InABrowser, WhatAPageMustNotDoIsSeen) {
  if (!hasChromium()) GTEST_SKIP() << "chromium is not installed: the page was not opened in a browser";
  std::string html = test::htmlOf(test::reportOf(test::badRun()));
  html.insert(html.find("</main>"),
              "<img src='http://192.0.2.1/x.png'><script>document.title='ran'</script>");
  const Browsed browsed = browse("foreign", html);
  EXPECT_THAT(browsed.messages, HasSubstr("192.0.2.1"));
  EXPECT_THAT(browsed.dom, Not(HasSubstr("<title>ran")));
}

}  // namespace
}  // namespace kerfbench::report
