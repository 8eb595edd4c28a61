// A parsed line: constants are already in its block, everything that must be computed is code for a
// small stack machine. Parsing happens once, evaluation each time the line runs; a plain line has
// no code and its block is used as it stands.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "interpreter/block.h"
#include "interpreter/operators.h"
#include "interpreter/statements.h"

namespace cnc::interp {

enum class Statement : std::uint8_t {
  block,  ///< words, settings and comments; also an empty line
  if_begin,
  if_else,
  if_end,
  while_begin,
  while_end,
  sub_begin,
  sub_end,
  gosub,
  message,  ///< msg warnmsg errmsg logmsg
  special,  ///< a row of special_statements()
};
/// Whether control goes on anywhere but behind the line.
[[nodiscard]] constexpr bool steers(Statement statement) {
  return statement >= Statement::if_begin && statement <= Statement::sub_end;
}

class ParameterNames;

struct Op {
  OpCode code;
  Span span;
  std::int32_t argument = 0;
  double number = 0.0;
};

struct Line {
  Statement statement = Statement::block;
  bool optional = false;    ///< begins with "/"
  MessageKind text_kind{};  ///< of a text statement
  Block block;
  std::vector<Op> code;
  std::vector<std::string_view> pieces;  ///< quoted texts, in the program's text
  std::string_view name;                 ///< of the sub in sub and gosub, in the program's text
  Span name_span;
  const SpecialStatement* special = nullptr;
  std::vector<Argument> arguments;  ///< of the special statement; values are computed by the code
  ParameterNames* names = nullptr;  ///< of the run; nullptr where the language has none

  void clear();
};

class ParameterAccess;

/// What evaluating a line yields.
struct Evaluation {
  Block block;
  double condition = 0.0;           ///< of if and while
  std::string text;                 ///< of a text statement
  std::vector<Argument> arguments;  ///< of a special statement
};

/// Runs the code of `line`; `result.block` becomes the complete block.
Accepted evaluate(const Line& line, const ParameterAccess& parameters, Evaluation& result);

/// A number in a text: at most six decimals, no trailing zeros, as short as it can be.
[[nodiscard]] std::string number_text(double value);

}  // namespace cnc::interp
