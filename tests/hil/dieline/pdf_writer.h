// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace kerfbench::dieline {

/// A PDF of these objects, numbered from 1; the first is the catalogue.
inline std::string pdfOf(const std::vector<std::string>& objects, const std::string& trailer = "") {
  std::string text = "%PDF-1.6\n";
  std::string table = "0000000000 65535 f \n";
  for (std::size_t i = 0; i < objects.size(); ++i) {
    char row[32];
    std::snprintf(row, sizeof row, "%010zu 00000 n \n", text.size());
    table += row;
    text += std::to_string(i + 1) + " 0 obj\n" + objects[i] + "\nendobj\n";
  }
  const std::string size = std::to_string(objects.size() + 1);
  return text + "xref\n0 " + size + "\n" + table + "trailer\n<< /Size " + size + " /Root 1 0 R " + trailer +
         " >>\nstartxref\n" + std::to_string(text.size()) + "\n%%EOF\n";
}

inline std::string pdfStream(const std::string& data, const std::string& keys = "") {
  return "<< /Length " + std::to_string(data.size()) + " " + keys + " >>\nstream\n" + data + "\nendstream";
}

/// What else a page of a test has.
struct PdfPage {
  std::string resources;  ///< Entries of its /Resources.
  std::string keys = "/MediaBox [0 0 720 360]";
  std::string catalogue;             ///< Entries of the catalogue.
  std::vector<std::string> objects;  ///< From number 5 on.
};

/// One page, by default of 10 x 5 inches.
inline std::string pdfPage(const std::string& content, const PdfPage& page = {}) {
  std::vector<std::string> objects{"<< /Type /Catalog /Pages 2 0 R " + page.catalogue + " >>",
                                   "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
                                   "<< /Type /Page /Parent 2 0 R /Contents 4 0 R /Resources << " +
                                       page.resources + " >> " + page.keys + " >>",
                                   pdfStream(content)};
  objects.insert(objects.end(), page.objects.begin(), page.objects.end());
  return pdfOf(objects);
}

/// A form XObject.
inline std::string pdfForm(const std::string& content, const std::string& resources = "",
                           const std::string& keys = "") {
  return pdfStream(content, "/Type /XObject /Subtype /Form /BBox [-1000 -1000 1000 1000] /Resources << " +
                                resources + " >> " + keys);
}

}  // namespace kerfbench::dieline
