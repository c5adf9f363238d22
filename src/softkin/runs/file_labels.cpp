#include <algorithm>
#include <filesystem>
#include <set>
#include <softkin/runs/file_labels.hpp>

namespace softkin::runs {

namespace {

using Texts = std::vector<std::string>;

bool are_distinct(const Texts& texts) {
  return std::set<std::string>(texts.begin(), texts.end()).size() == texts.size();
}

/// The file's name behind so many of its folders.
std::string with_folders(const std::string& file, std::size_t folders) {
  const std::filesystem::path path(file);
  const std::size_t parts = std::distance(path.begin(), path.end());
  std::filesystem::path tail;
  for (auto part = std::next(path.begin(), parts - std::min(parts, folders + 1)); part != path.end(); ++part)
    tail /= *part;
  return tail.string();
}

Texts numbered(const Texts& labels) {
  Texts result;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto same = std::count(labels.begin(), labels.begin() + static_cast<std::ptrdiff_t>(i) + 1, labels[i]);
    const bool alone = std::count(labels.begin(), labels.end(), labels[i]) == 1;
    result.push_back(alone ? labels[i] : labels[i] + " (" + std::to_string(same) + ")");
  }
  return result;
}

}  // namespace

std::vector<std::string> file_labels(const std::vector<std::string>& files, const std::vector<std::string>& tails) {
  const auto labels_by = [&](auto&& short_name) {
    Texts labels;
    for (std::size_t i = 0; i < files.size(); ++i)
      labels.push_back(short_name(files[i]) + (tails.empty() ? "" : tails[i]));
    return labels;
  };
  Texts labels = labels_by([](const std::string& file) { return std::filesystem::path(file).stem().string(); });
  if (are_distinct(labels)) return labels;
  std::size_t deepest = 0;
  for (const std::string& file : files) deepest = std::max(deepest, file.size());  // more than it has folders
  for (std::size_t folders = 0; folders <= deepest; ++folders) {
    Texts longer = labels_by([folders](const std::string& file) { return with_folders(file, folders); });
    const bool all = folders > 0 && longer == labels;
    labels = std::move(longer);
    if (all || are_distinct(labels)) break;
  }
  return numbered(labels);
}

}  // namespace softkin::runs
