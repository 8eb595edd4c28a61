// The form of an ini file: which text stands where, without knowing any setting.
//
//   ; a comment, also with #
//   [SECTION]
//   key = value    ; a comment may follow
//
// All views point into the text that was parsed, so that a value can be replaced in its place and
// every other byte of the operator's file (comments, order, blanks, line ends) stays as it is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "config/error.h"

namespace cnc::config {

struct IniEntry {
  std::string_view section;
  std::string_view key;
  std::string_view value;
  TextPlace place;  ///< of the value
};

struct IniSection {
  std::string_view name;
  TextPlace place;
  std::size_t end = 0;  ///< offset behind the last line of the section that is not a comment
};

struct IniDocument {
  std::vector<IniSection> sections;
  std::vector<IniEntry> entries;
  std::vector<Error> errors;  ///< lines that are neither of the forms above; at most kMaxIniErrors
};

inline constexpr std::size_t kMaxIniErrors = 50;  ///< more are of no help to a person

/// `name` is the file's name for errors. `text` must outlive the document.
[[nodiscard]] IniDocument parse_ini(std::string_view text, std::string_view name);

/// Puts `replacement` in the place of `length` bytes from `offset` on.
struct TextEdit {
  std::size_t offset = 0;
  std::size_t length = 0;
  std::string replacement;
};

/// The text with all edits done; they do not overlap, and those of one offset keep their order.
[[nodiscard]] std::string with_edits(std::string_view text, std::vector<TextEdit> edits);

}  // namespace cnc::config
