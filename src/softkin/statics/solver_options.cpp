#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/statics/solver_option_fields.hpp>

namespace softkin {

namespace {

const SolverOptions defaults{};

bool is_admissible(OptionRange range, double value) {
  switch (range) {
    case OptionRange::reduction:
      return value > 0 && value < 1;
    case OptionRange::fraction:
      return value > 0 && value <= 1;
    case OptionRange::growth:
      return value > 1 && std::isfinite(value);
    case OptionRange::positive:
      return value > 0 && std::isfinite(value);
    case OptionRange::count:
      return value >= 1 && value <= 1e9 && value == std::floor(value);
    case OptionRange::any:
      break;
  }
  return std::isfinite(value);
}

const char* range_text(OptionRange range) {
  switch (range) {
    case OptionRange::reduction:
      return "between 0 and 1";
    case OptionRange::fraction:
      return "above 0 and at most 1";
    case OptionRange::growth:
      return "above 1";
    case OptionRange::positive:
      return "above 0";
    case OptionRange::count:
      return "a whole number of at least 1";
    case OptionRange::any:
      break;
  }
  return "a finite number";
}

const char* kind_text(OptionKind kind) {
  return kind == OptionKind::derived ? "derived" : kind == OptionKind::measured ? "measured" : "order of magnitude";
}

[[noreturn]] void refuse(const std::string& group, const OptionField& field, double value) {
  throw InvalidInput("the option " + group + "." + field.name + " must be " + range_text(field.range) + ", not " +
                     number(value));
}

std::vector<std::string> groups() {
  std::vector<std::string> names;
  visit_groups(defaults, [&](const char* group, const char*, const auto&) { names.emplace_back(group); });
  return names;
}

}  // namespace

std::vector<OptionValue> list_options(const SolverOptions& options) {
  std::vector<OptionValue> all;
  visit_groups(options, [&](const char* group, const char*, const auto& of_group) {
    visit_fields(of_group, [&](const OptionField& field, const auto& value) {
      all.push_back({group, field, static_cast<double>(value), 0});
    });
  });
  std::size_t i = 0;
  visit_groups(defaults, [&](const char*, const char*, const auto& of_group) {
    visit_fields(of_group,
                 [&](const OptionField&, const auto& value) { all[i++].standard = static_cast<double>(value); });
  });
  return all;
}

std::vector<OptionValue> changed_options(const SolverOptions& options) {
  std::vector<OptionValue> changed = list_options(options);
  std::erase_if(changed, [](const OptionValue& option) { return option.value == option.standard; });
  return changed;
}

std::string changes_text(const SolverOptions& options) {
  std::string text;
  for (const OptionValue& option : changed_options(options))
    text += (text.empty() ? "" : ", ") + option.group + "." + option.field.name + " = " + exact(option.value);
  return text;
}

void check_option_group(const std::string& group) {
  const std::vector<std::string> known = groups();
  if (std::find(known.begin(), known.end(), group) == known.end())
    throw InvalidInput("no group of options is called '" + group + "'" + suggest_name(group, known));
}

void set_option(SolverOptions& options, const std::string& group, const std::string& name, double value) {
  check_option_group(group);
  bool found = false;
  std::vector<std::string> known;
  visit_groups(options, [&](const char* of, const char*, auto& of_group) {
    if (of != group) return;
    visit_fields(of_group, [&](const OptionField& field, auto& target) {
      known.emplace_back(field.name);
      if (field.name != name) return;
      if (!is_admissible(field.range, value)) refuse(group, field, value);
      target = static_cast<std::remove_reference_t<decltype(target)>>(value);
      found = true;
    });
  });
  if (!found) throw InvalidInput("the options of '" + group + "' have no '" + name + "'" + suggest_name(name, known));
}

void check_options(const SolverOptions& options) {
  visit_groups(options, [](const char* group, const char*, const auto& of_group) {
    visit_fields(of_group, [&](const OptionField& field, const auto& value) {
      if (!is_admissible(field.range, static_cast<double>(value))) refuse(group, field, static_cast<double>(value));
    });
  });
}

std::string option_tables() {
  std::string text;
  visit_groups(defaults, [&](const char* group, const char* description, const auto& of_group) {
    text += "### `" + std::string(group) + "`\n\n" + description + "\n\n" +
            "| name | default | unit | meaning | kind |\n|---|---|---|---|---|\n";
    visit_fields(of_group, [&](const OptionField& field, const auto& value) {
      text += "| `" + std::string(field.name) + "` | " + number(static_cast<double>(value)) + " | " + field.unit +
              " | " + field.sentence + " | " + kind_text(field.kind) + " |\n";
    });
    text += "\n";
  });
  return text;
}

}  // namespace softkin
