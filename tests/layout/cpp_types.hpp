#pragma once

#include <algorithm>
#include <cctype>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace softkin::testing {

struct Token {
  std::string text;  // a string literal is ""
  std::size_t line;
};

/// Words and signs of C++ text, one by one but for `::`; without comments, preprocessor lines and what literals hold.
class Tokenizer {
 public:
  explicit Tokenizer(const std::string& text) : text_(text) {}

  std::vector<Token> tokens() {
    while (at_ < text_.size()) step();
    return std::move(tokens_);
  }
  static bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

 private:
  [[nodiscard]] char look(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }
  void step() {
    const char c = look();
    if (c == '\n') fresh_line_ = true;
    if (std::isspace(static_cast<unsigned char>(c))) return skip(1);
    if (c == '/' && look(1) == '/') return skip_line();
    if (c == '/' && look(1) == '*') return skip_to("*/");
    if (c == '#' && fresh_line_) return skip_line();
    fresh_line_ = false;
    if (c == '"' || c == '\'') return literal(c);
    if (is_word(c)) return word();
    const std::size_t length = c == ':' && look(1) == ':' ? 2 : 1;
    tokens_.push_back({text_.substr(at_, length), line_});
    skip(length);
  }

  void skip(std::size_t count) {
    for (; count > 0 && at_ < text_.size(); --count) line_ += text_[at_++] == '\n';
  }
  void skip_to(const std::string& end) {
    const std::size_t found = text_.find(end, at_ + 1);
    skip(found == std::string::npos ? text_.size() : found + end.size() - at_);
  }
  void skip_line() {
    while (at_ < text_.size() && look() != '\n') skip(look() == '\\' ? 2 : 1);
  }

  void word() {
    const std::size_t begin = at_;
    const bool number = std::isdigit(static_cast<unsigned char>(look()));
    while (is_word(look()) || (number && (look() == '\'' || look() == '.'))) skip(1);
    const std::string text = text_.substr(begin, at_ - begin);
    if (look() == '"' && text.ends_with('R')) {  // a raw literal
      const std::string mark = text_.substr(at_ + 1, text_.find('(', at_) - at_ - 1);
      tokens_.push_back({"\"\"", line_});
      return skip_to(")" + mark + "\"");
    }
    tokens_.push_back({text, line_});
  }

  void literal(char quote) {
    tokens_.push_back({"\"\"", line_});
    skip(1);
    while (at_ < text_.size() && look() != quote) skip(look() == '\\' ? 2 : 1);
    skip(1);
  }

  const std::string& text_;
  std::size_t at_ = 0, line_ = 1;
  bool fresh_line_ = true;
  std::vector<Token> tokens_;
};

struct TypeDefinition {
  std::string name;  // qualified; of a specialisation with its arguments
  std::size_t line;
};

/// Where a text defines classes, structs, unions and enumerations with external linkage. Macros are not expanded, and
/// all branches of an #if are read.
class TypeFinder {
 public:
  explicit TypeFinder(const std::string& text) : tokens_(Tokenizer(text).tokens()) {}

  std::vector<TypeDefinition> types() {
    for (at_ = 0; at_ < tokens_.size(); ++at_) {
      const std::string& word = look();
      if (word == "namespace") {
        enter_namespace();
      } else if (word == "extern" && look(1) == "\"\"" && look(2) == "{") {
        at_ += 2;
        scopes_.push_back(scopes_.back());
      } else if (word == "class" || word == "struct" || word == "union" || word == "enum") {
        enter_type();
      } else if (word == "{") {
        scopes_.emplace_back();
      } else if (word == "}") {
        if (scopes_.size() == 1) throw std::runtime_error("'}' without '{' in line " + std::to_string(line()));
        scopes_.pop_back();
      }
    }
    if (scopes_.size() != 1) throw std::runtime_error("'{' without '}'");
    return std::move(types_);
  }

 private:
  using Scope =
      std::optional<std::string>;  // what stands before a name; none: what is named here is not seen elsewhere

  [[nodiscard]] const std::string& look(std::size_t ahead = 0) const {
    static const std::string end;
    return at_ + ahead < tokens_.size() ? tokens_[at_ + ahead].text : end;
  }
  [[nodiscard]] std::size_t line() const { return tokens_[at_].line; }
  static bool is_name(const std::string& text) {
    return !text.empty() && (std::isalpha(static_cast<unsigned char>(text[0])) || text[0] == '_');
  }
  static bool is_macro(const std::string& text) {
    return is_name(text) && std::none_of(text.begin(), text.end(), [](unsigned char c) { return std::islower(c); });
  }

  void enter_namespace() {
    std::string name;
    for (++at_; is_name(look()) || look() == "::"; ++at_)
      if (look() != "inline") name += look();
    if (look() != "{") return;  // an alias, a using
    scopes_.push_back(name.empty() || !scopes_.back() ? Scope{} : *scopes_.back() + name + "::");
  }

  void enter_type() {
    const bool enumeration = look() == "enum";
    if (enumeration && (look(1) == "class" || look(1) == "struct")) ++at_;
    ++at_;
    skip_attributes();
    const std::size_t named_at = line_or_last();
    const std::string name = qualified_name();
    if (look() == "final") ++at_;
    if (look() == ":") skip_bases();
    if (look() != "{") {  // declared only; what stands here may matter to the caller
      --at_;
      return;
    }
    const bool seen = scopes_.back() && !name.empty();
    if (seen) types_.push_back({*scopes_.back() + name, named_at});
    scopes_.push_back(seen && !enumeration ? Scope{*scopes_.back() + name + "::"} : Scope{});
  }

  [[nodiscard]] std::size_t line_or_last() const { return tokens_[std::min(at_, tokens_.size() - 1)].line; }

  void skip_attributes() {
    while (true) {
      if (look() == "[")
        skip_pair("[", "]");
      else if (look() == "alignas")
        ++at_, skip_pair("(", ")");
      else if (is_macro(look()) && is_name(look(1)) && look(1) != "final")
        ++at_;
      else
        return;
    }
  }

  /// From the opening sign to behind the closing one; the text between.
  std::string skip_pair(const std::string& open, const std::string& close) {
    std::string text;
    for (int depth = 0; at_ < tokens_.size(); ++at_) {
      depth += look() == open;
      depth -= look() == close;
      if (depth == 0) {
        ++at_;
        break;
      }
      text += (is_name(look()) && !text.empty() && is_name(text.substr(text.size() - 1)) ? " " : "") + look();
    }
    return text + close;
  }

  std::string qualified_name() {
    std::string name;
    while ((is_name(look()) && look() != "final" && (name.empty() || name.ends_with("::"))) || look() == "::") {
      name += tokens_[at_++].text;
      if (look() == "<") name += skip_pair("<", ">");
    }
    return name;
  }

  void skip_bases() {
    for (; at_ < tokens_.size() && look() != "{" && look() != ";" && look() != ")"; ++at_)
      if (look() == "(") skip_pair("(", ")"), --at_;
  }

  std::vector<Token> tokens_;
  std::size_t at_ = 0;
  std::vector<Scope> scopes_{Scope{""}};
  std::vector<TypeDefinition> types_;
};

}  // namespace softkin::testing
