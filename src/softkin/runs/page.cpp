#include <filesystem>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/core/version.hpp>
#include <softkin/io/file.hpp>
#include <softkin/runs/page.hpp>

namespace softkin::runs {

std::string page_refusal(const std::string& file) {
  if (std::filesystem::path(file).extension() != ".html") return "must end in .html, not " + file;
  return page_is_there() ? "" : no_page;
}

std::string page_html(std::string_view page, std::string_view document) {
  constexpr std::string_view element = "<script type=\"application/json\" id=\"softkin-page\">", end = "</script>";
  const std::size_t at = page.find(element), begin = at + element.size();
  const std::size_t rest = at == std::string_view::npos ? at : page.find(end, begin);
  if (rest == std::string_view::npos || page.find(element, begin) != std::string_view::npos)
    throw InvalidInput("the page has no one place for what it shows");
  std::string html(page.substr(0, begin));
  html.reserve(page.size() + document.size() + document.size() / 64);
  for (const char c : document) {
    if (c == '<')  // of </script, or <!--
      html += "\\u003c";
    else
      html += c;
  }
  return html.append(page.substr(rest));
}

std::string command_line(const std::vector<std::string>& words) {
  constexpr std::string_view plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=./:,@%";
  std::string line;
  for (const std::string& word : words) {
    if (!line.empty()) line += ' ';
    if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) {
      line += word;
      continue;
    }
    line += '\'';
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

namespace {

std::string typed;

std::string text_of(const std::string& file, std::size_t bytes) {
  return "page: " + file + " (" + decimal(static_cast<double>(bytes) / 1e6, 1) + " MB; open it in a browser)";
}

}  // namespace

void keep_command(std::vector<std::string> words) {
  if (!words.empty()) words.front() = "softkin";
  typed = command_line(words);
}

const std::string& kept_command() {
  return typed;
}

RunPage::RunPage(std::string file, const Model& model, std::string command) : file_(std::move(file)), model_(model) {
  if (!file_.empty()) document_.emplace(model, std::move(command));
}

void RunPage::add(const StepRecord& record, const Points& positions, const ElementDeformation* made,
                  const Statics* statics) {
  if (made != nullptr) return document_->add(record, positions, *made);
  const bool presses = statics != nullptr && model_.contact.any();
  document_->add(record, positions,
                 presses ? statics->measured(state_of(model_, record, positions)) : deformation_of(model_, positions));
}

void RunPage::show_reach(Index marker, const Points& positions) {
  if (!document_) return;
  document_->show_reach(marker, positions);
  reaches_ = true;
}

void RunPage::write() {
  if (!document_ || (document_->steps() == 0 && map_ == nullptr && !reaches_)) return;
  const std::string html = page_html(embedded_page(), document_->text(map_));
  write_file(file_, html);
  bytes_ = html.size();
}

std::string RunPage::reported() const {
  return bytes_ == 0 ? "" : text_of(file_, bytes_);
}

std::string write_comparison_page(const std::string& file, const Comparison& comparison, const std::string& command) {
  nlohmann::json tables = nlohmann::json::array();
  for (const auto& [caption, table] : comparison.tables)
    tables.push_back({{"caption", caption}, {"rows", table.cells()}});
  const nlohmann::json document{
      {"softkin", version()},
      {"command", command},
      {"comparison", {{"notes", comparison.notes}, {"tables", tables}, {"plot", svg_text(comparison.plot)}}}};
  const std::string html = page_html(embedded_page(), document.dump());
  write_file(file, html);
  return text_of(file, html.size());
}

}  // namespace softkin::runs
