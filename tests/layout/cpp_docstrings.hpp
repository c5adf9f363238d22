#pragma once

#include <set>
#include <sstream>

#include "layout/cpp_types.hpp"

namespace softkin::testing {

/// Finds the public names of a header that have no comment. A name has one where
/// - lines of comments stand directly above its declaration, indented as it is, or
/// - a comment stands behind it, on a line of its declaration (of a class its head, of a function before its body), or
/// - it continues a run of declarations, without an empty line between, the first of which has a comment above.
/// No comment is required of classes that are only declared, special members (destructors, copies, moves, defaulted or
/// deleted ones), overriders, friends, using declarations and enumerators, nor of members that are not public.
class DocstringFinder {
 public:
  explicit DocstringFinder(const std::string& text) : tokens_(Tokenizer(text).tokens()) {
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
      const std::size_t begin = line.find_first_not_of(' ');
      const std::size_t comment = line.find("//");
      lines_.push_back({begin, comment != std::string::npos, comment != std::string::npos && comment == begin});
    }
    read_scope("", true);
  }

  struct Name {
    std::string name;
    std::size_t line;
  };
  [[nodiscard]] const std::vector<Name>& bare() const { return bare_; }
  [[nodiscard]] std::size_t names() const { return names_; }

 private:
  struct Line {
    std::size_t indent;
    bool comment, comment_alone;
  };
  struct Item {
    std::string name;
    std::size_t first = 0, head = 0, last = 0;  // lines: its first one, where its head ends, its last one
    bool requested = true, type = false;
  };

  [[nodiscard]] const std::string& look(std::size_t at) const {
    static const std::string end;
    return at < tokens_.size() ? tokens_[at].text : end;
  }
  static bool is_word(const std::string& text) {
    return !text.empty() && (std::isalnum(static_cast<unsigned char>(text[0])) || text[0] == '_');
  }

  void read_scope(const std::string& owner, bool seen) {
    std::size_t last = 0;  // line of the declaration before
    bool run = false;      // had it, or the first of its run, a comment above
    while (at_ < tokens_.size() && look(at_) != "}") {
      if (look(at_) == ";") {
        ++at_;
      } else if (look(at_) == "namespace") {
        read_namespace(owner);
        last = 0;
      } else if ((look(at_) == "public" || look(at_) == "private" || look(at_) == "protected") &&
                 look(at_ + 1) == ":") {
        seen = look(at_) == "public";
        at_ += 2;
      } else {
        const Item item = read_item(owner, seen);
        run = has_comment_above(item) || (run && item.first == last + 1);
        last = item.type ? 0 : item.last;  // the comment of a class does not apply to the next declaration
        if (seen && item.requested) {
          ++names_;
          if (!run && !has_comment_behind(item)) bare_.push_back({owner + item.name, item.first});
        }
      }
    }
    if (at_ < tokens_.size()) ++at_;
  }

  void read_namespace(const std::string& owner) {
    for (; at_ < tokens_.size() && look(at_) != "{" && look(at_) != ";"; ++at_)
      ;
    if (look(at_++) == "{") read_scope(owner, true);
  }

  [[nodiscard]] bool has_comment_above(const Item& item) const {
    if (item.first < 2) return false;
    const Line &above = lines_[item.first - 2], &own = lines_[item.first - 1];
    return above.comment_alone && above.indent == own.indent;
  }
  [[nodiscard]] bool has_comment_behind(const Item& item) const {
    for (std::size_t line = item.first; line <= item.head; ++line)
      if (lines_[line - 1].comment) return true;
    return false;
  }

  /// One declaration; of a class its members, too.
  Item read_item(const std::string& owner, bool seen) {
    const std::size_t begin = at_;
    Item item;
    item.first = tokens_[at_].line;
    if (look(at_) == "template") ++at_, skip("<", ">");
    while (look(at_) == "[") skip("[", "]");
    const std::string key = look(at_);
    const bool type = key == "class" || key == "struct" || key == "union" || key == "enum";
    item.type = type;
    read_head(item, type);
    if (look(at_) == "{" && type && key != "enum") {
      item.head = tokens_[at_].line;
      ++at_;
      const std::string inside = owner + item.name + "::";
      if (seen)
        read_scope(inside, key != "class");
      else
        --at_, skip("{", "}");
      for (; at_ < tokens_.size() && look(at_) != ";"; ++at_)
        ;
    } else if (look(at_) == "{") {  // a function, an enumeration
      item.head = tokens_[at_].line;
      skip("{", "}");
      if (type && tokens_[at_ - 1].line == item.first) item.head = item.first;
    } else {
      item.requested = item.requested && !type;  // a class that is declared alone
      item.head = at_ < tokens_.size() ? tokens_[at_].line : item.first;
    }
    if (look(at_) == ";") ++at_;
    item.last = tokens_[at_ - 1].line;
    item.requested = item.requested && !says_nothing_new(begin, item);
    return item;
  }

  /// Up to the `;` that ends a declaration, or to the brace of its body or members.
  void read_head(Item& item, bool type) {
    int angles = 0;
    bool called = false, assigned = false, named = false, initialised = false;
    for (; at_ < tokens_.size(); ++at_) {
      const std::string& word = look(at_);
      if (word == ";") return;
      if (word == "operator" && !named) {
        for (item.name = word; look(++at_) != "(" || look(at_ + 1) == ")";) item.name += look(at_);
        named = true;
        --at_;
      } else if (word == "(") {
        if (angles == 0 && !assigned) called = true;
        if (angles == 0) named = true;
        skip("(", ")"), --at_;
      } else if (word == "[") {
        skip("[", "]"), --at_;
      } else if (word == "<" && !assigned) {
        ++angles;
      } else if (word == ">" && !assigned && look(at_ - 1) != "-") {
        --angles;
      } else if (word == "=") {
        assigned = named = true;
      } else if (word == ":" && (called || type)) {
        initialised = called;
        named = true;
      } else if (word == "{") {
        const std::string& before = look(at_ - 1);
        const bool value = assigned || !called || (initialised && before != ")" && before != "}");
        if (type || !value) return;
        named = true;
        skip("{", "}"), --at_;
      } else if (is_word(word) && angles == 0 && !named && word != "final") {
        item.name = word;
      }
    }
  }

  [[nodiscard]] bool says_nothing_new(std::size_t begin, const Item& item) const {
    const std::string& first = look(begin);
    if (first == "friend" || first == "static_assert") return true;
    bool assigned = false;
    for (std::size_t i = begin; i < at_; ++i) {
      const std::string& word = look(i);
      if (word == "{") break;
      assigned = assigned || word == "=";
      if (word == "override" || word == "~") return true;
      if (word == "=" && (look(i + 1) == "default" || look(i + 1) == "delete")) return true;
      if (word == "operator" && look(i + 1) == "=") return true;
      if (word == "::" && look(i + 1) == item.name && look(i + 2) == "(" && is_word(look(i - 1))) return true;
      if (word == item.name && look(i + 1) == "(" && copies(i)) return true;
    }
    return first == "using" && !assigned;
  }
  /// Is what is called at a token a copy or a move of itself?
  [[nodiscard]] bool copies(std::size_t at) const {
    const std::size_t taken = at + (look(at + 2) == "const" ? 3 : 2);
    return look(taken) == look(at) && look(taken + 1) == "&";
  }

  /// From the opening sign to behind the closing one.
  void skip(const std::string& open, const std::string& close) {
    for (int depth = 0; at_ < tokens_.size(); ++at_) {
      depth += look(at_) == open;
      depth -= look(at_) == close;
      if (depth == 0) {
        ++at_;
        return;
      }
    }
    throw std::runtime_error("'" + open + "' without '" + close + "'");
  }

  std::vector<Token> tokens_;
  std::vector<Line> lines_;
  std::size_t at_ = 0, names_ = 0;
  std::vector<Name> bare_;
};

}  // namespace softkin::testing
