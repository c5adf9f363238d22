#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <softkin/runs/page.hpp>
#include <string>

#include "fk_samples.hpp"

namespace softkin::testing {

/// What a page shows.
inline nlohmann::json shown_by(const std::string& file) {
  const std::string html = read_text(file), element = "<script type=\"application/json\" id=\"softkin-page\">";
  const std::size_t begin = html.find(element) + element.size();
  EXPECT_GT(begin, element.size()) << file;
  return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

/// Returns the start of the line in which a command reports its page.
inline std::string reported_of_page(const std::string& file) {
  return "page: " + file + " (";
}

}  // namespace softkin::testing

#define SKIP_WITHOUT_PAGE() \
  if (!softkin::runs::page_is_there()) GTEST_SKIP() << "built without the page"
