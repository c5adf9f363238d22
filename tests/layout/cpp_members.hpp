#pragma once

#include "layout/cpp_types.hpp"

namespace softkin::testing {

struct MemberCount {
  std::string name;  // of the type
  std::size_t line, members;
};

/// How many data members of its own each class, struct and union of a text has, nested ones too, but those in member
/// functions; not what is static, and no pointers to functions.
class MemberCounter {
 public:
  explicit MemberCounter(const std::string& text) : tokens_(Tokenizer(text).tokens()) {}

  std::vector<MemberCount> types() {
    for (at_ = 0; at_ < tokens_.size(); ++at_)
      if (begins_type()) type();
    return std::move(types_);
  }

 private:
  [[nodiscard]] const std::string& look(std::size_t at) const {
    static const std::string end;
    return at < tokens_.size() ? tokens_[at].text : end;
  }
  [[nodiscard]] bool begins_type() const {
    if (look(at_) != "class" && look(at_) != "struct" && look(at_) != "union") return false;
    if (at_ > 0 && (look(at_ - 1) == "enum" || look(at_ - 1) == "<" || look(at_ - 1) == ",")) return false;
    for (std::size_t i = at_; i < tokens_.size(); ++i) {
      if (look(i) == "{") return true;
      if (look(i) == ";" || look(i) == "(" || look(i) == ")" || look(i) == "=") return false;
    }
    return false;
  }

  /// From its keyword to its closing brace.
  void type() {
    const std::size_t index = types_.size();
    types_.push_back({look(at_ + 1), tokens_[at_].line, 0});
    while (look(at_) != "{") ++at_;
    for (++at_; at_ < tokens_.size() && look(at_) != "}";) {
      const std::size_t members = declaration();
      types_[index].members += members;
    }
  }

  /// How many members it declares; at_ goes behind it.
  std::size_t declaration() {
    static const std::vector<std::string> none{"using",    "typedef", "friend",       "static",
                                               "template", "enum",    "static_assert"};
    if (look(at_ + 1) == ":" && (look(at_) == "public" || look(at_) == "private" || look(at_) == "protected")) {
      at_ += 2;
      return 0;
    }
    const bool data = std::find(none.begin(), none.end(), look(at_)) == none.end();
    bool function = false, value = false, initialisers = false, named = false;
    std::size_t count = 1;
    for (; at_ < tokens_.size(); ++at_) {
      const std::string& sign = look(at_);
      if (sign == ";") {
        ++at_;
        break;
      }
      if (begins_type()) {
        type();
        named = false;
        continue;
      }
      if (sign == "{") {
        const bool body = function && !(initialisers && is_word(look(at_ - 1)));
        skip_pair("{", "}");
        if (!body) continue;
        ++at_;
        return 0;
      }
      if (sign == "(") {
        function = function || !value;
        skip_pair("(", ")");
      } else if (sign == "[") {
        skip_pair("[", "]");
      } else if (sign == "<" && !value) {
        skip_pair("<", ">");
      } else if (sign == ",") {
        ++count;
        value = false;
      } else if (sign == "=") {
        value = true;
      } else if (sign == ":") {
        initialisers = function;
      } else {
        named = named || is_word(sign);
      }
    }
    return data && !function && named ? count : 0;
  }
  static bool is_word(const std::string& text) { return !text.empty() && Tokenizer::is_word(text[0]); }
  /// From the opening sign to the closing one.
  void skip_pair(const std::string& open, const std::string& close) {
    for (int depth = 0; at_ < tokens_.size(); ++at_) {
      depth += look(at_) == open;
      depth -= look(at_) == close;
      if (depth == 0) return;
    }
  }

  std::vector<Token> tokens_;
  std::size_t at_ = 0;
  std::vector<MemberCount> types_;
};

}  // namespace softkin::testing
