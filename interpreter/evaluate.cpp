// The stack machine that computes the values of a line.
#include <array>
#include <cmath>
#include <fmt/format.h>

#include "interpreter/expression_parser.h"
#include "interpreter/line.h"
#include "interpreter/parameter_access.h"

namespace cnc::interp {
namespace {

class Evaluator {
 public:
  Evaluator(const Line& line, const ParameterAccess& parameters, Evaluation& result)
      : line_(line), parameters_(parameters), result_(result) {}

  Accepted run() {
    for (const Op& op : line_.code) {
      // Half of all steps, and they cannot fail.
      if (op.code == OpCode::push_number) {
        push(op.number);
      } else if (op.code == OpCode::load_parameter) {
        push(parameters_.get(op.argument));
      } else if (Accepted done = step(op); !done) {
        return done;
      }
    }
    return {};
  }

 private:
  // The parser has counted the stack's depth and refused what would not fit.
  void push(double value) { stack_[depth_++] = value; }
  double pop() { return stack_[--depth_]; }

  Accepted push(Parsed<double> value) {
    if (!value) return std::unexpected(std::move(value.error()));
    push(*value);
    return {};
  }

  Accepted step(const Op& op) {
    if (op.code >= OpCode::store_word) return store(op);
    if (op.code >= OpCode::power) {
      const double right = pop();
      const double left = pop();
      return push(apply_binary(op.code, left, right, op.span));
    }
    if (op.code >= OpCode::negate) return push(apply_unary(op.code, pop(), op.span));
    if (op.code == OpCode::load_named) return push(named(op));
    if (op.code == OpCode::name_exists) {
      return push(Parsed<double>(parameters_.names().find(op.argument) ? 1.0 : 0.0));
    }
    const auto number = parameter_number(pop(), op.span);  // load_indirect
    if (!number) return std::unexpected(number.error());
    push(parameters_.get(*number));
    return {};
  }

  Accepted store(const Op& op) {
    switch (op.code) {
      case OpCode::store_word:
        return result_.block.add_word(static_cast<char>(op.argument), pop(), op.span);
      case OpCode::store_parameter:
        return set_parameter(op.argument, pop(), op.span);
      case OpCode::store_indirect:
        return set_indirect(op.span);
      case OpCode::store_condition:
        result_.condition = pop();
        return {};
      case OpCode::append_text:
        result_.text += line_.pieces[static_cast<std::size_t>(op.argument)];
        return {};
      case OpCode::append_value:
        result_.text += number_text(pop());
        return {};
      case OpCode::store_argument:
        result_.arguments[static_cast<std::size_t>(op.argument)].value = pop();
        return {};
      default:
        break;
    }
    return refuse(ErrorCode::internal_error, op.span, "Not a sink.");
  }

  Parsed<double> named(const Op& op) const {
    if (const auto value = parameters_.names().find(op.argument)) return *value;
    const std::string& name = parameters_.names().name_of(op.argument);
    return refuse(ErrorCode::parameter_unset, op.span, fmt::format("#<{}> has no value yet.", name),
                  name.front() == '_' ? "#<_name> = value before it is read."
                                      : "#<name> = value before it is read, in the same sub; "
                                        "#<_name> holds in all of them.");
  }

  Accepted set_indirect(Span span) {
    const double value = pop();
    const auto number = parameter_number(pop(), span);
    if (!number) return std::unexpected(number.error());
    return set_parameter(*number, value, span);
  }

  Accepted set_parameter(std::int32_t number, double value, Span span) {
    const ParameterSetting setting{number, value, span};
    if (Accepted allowed = parameters_.check(setting); !allowed) return allowed;
    result_.block.add_setting(setting);
    return {};
  }

  const Line& line_;
  const ParameterAccess& parameters_;
  Evaluation& result_;
  std::array<double, kMaxStackDepth> stack_;
  std::size_t depth_ = 0;
};

}  // namespace

void Line::clear() {
  statement = Statement::block;
  optional = false;
  block.clear();
  code.clear();
  pieces.clear();
  name = {};
  arguments.clear();
}

Accepted evaluate(const Line& line, const ParameterAccess& parameters, Evaluation& result) {
  result.block.take_over(line.block);
  result.condition = 0.0;
  result.text.clear();
  result.arguments = line.arguments;
  return Evaluator(line, parameters, result).run();
}

std::string number_text(double value) {
  std::string text = fmt::format("{:.6f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

}  // namespace cnc::interp
