// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

// The tables of docs/reference, so that tests can hold them against the program.
namespace kerfbench::docs {

inline std::filesystem::path referencePage(const std::string& name) {
  return std::filesystem::path(KERFBENCH_SOURCE_DIR) / "docs" / "reference" / name;
}

/// Text of a page. @throws std::runtime_error if there is none.
inline std::string pageText(const std::string& name) {
  std::ifstream file(referencePage(name), std::ios::binary);
  if (!file) throw std::runtime_error("there is no " + referencePage(name).string());
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Words of a text between two backticks.
inline std::vector<std::string> inBackticks(const std::string& text) {
  std::vector<std::string> words;
  for (auto begin = text.find('`'); begin != std::string::npos;) {
    const auto end = text.find('`', begin + 1);
    if (end == std::string::npos) break;
    words.push_back(text.substr(begin + 1, end - begin - 1));
    begin = text.find('`', end + 1);
  }
  return words;
}

/// Cells of a table's row, without the blanks around them.
inline std::vector<std::string> cellsOf(const std::string& row) {
  std::vector<std::string> cells;
  std::istringstream line(row);
  std::string cell;
  std::getline(line, cell, '|');  // The text before the first bar is no cell.
  while (std::getline(line, cell, '|')) {
    const auto begin = cell.find_first_not_of(' ');
    cells.push_back(begin == std::string::npos ? ""
                                               : cell.substr(begin, cell.find_last_not_of(' ') - begin + 1));
  }
  return cells;
}

/// A row of a table, by the headings of its columns.
using Row = std::map<std::string, std::string>;

/// Rows of all tables of a page whose first column is headed `heading`, by the text in backticks in that
/// column. A line `Prefix: `a.` `b.`` says with which prefixes the keys of the tables below it are read, up
/// to the next heading of level two.
inline std::map<std::string, Row> tableRows(const std::string& page, const std::string& heading) {
  std::istringstream text(pageText(page));
  std::map<std::string, Row> rows;
  std::vector<std::string> prefixes{""};
  std::vector<std::string> columns;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("## ")) prefixes = {""};
    if (line.starts_with("Prefix: ")) prefixes = inBackticks(line);
    if (!line.starts_with("|")) columns.clear();
    if (line.starts_with("| " + heading + " |")) columns = cellsOf(line);
    if (columns.empty() || !line.starts_with("| `")) continue;
    const std::vector<std::string> cells = cellsOf(line);
    Row row;
    for (std::size_t i = 0; i < columns.size() && i < cells.size(); ++i) row[columns[i]] = cells[i];
    for (const std::string& key : inBackticks(cells.at(0))) {
      for (const std::string& prefix : prefixes) {
        if (!rows.emplace(prefix + key, row).second)
          throw std::runtime_error(page + " has " + prefix + key + " twice");
      }
    }
  }
  return rows;
}

}  // namespace kerfbench::docs
