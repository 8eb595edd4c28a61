// Where the program goes on: if and while, subs, subs in place of M codes, and what a macro file
// does when it is loaded.
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <utility>

#include "interpreter/line_parser.h"
#include "interpreter/runner.h"

namespace cnc::interp {
namespace {

constexpr std::int32_t kToolChange = 6;  // M6
constexpr std::string_view kToolChangeSub = "change_tool";
constexpr std::int32_t kNewTool = 5011;
/// Words of a user M code: #1 is A … #26 is Z; not given = this (manual 4.4).
constexpr std::int32_t kWordParameters = 26;
constexpr double kNotGiven = -1e10;

/// What a statement lacks that has no partner.
[[nodiscard]] std::string_view missing_partner(Statement statement) {
  switch (statement) {
    case Statement::if_begin:
      return "endif";
    case Statement::if_else:
      return "if before and endif behind it";
    case Statement::if_end:
      return "if";
    case Statement::while_begin:
      return "endwhile";
    case Statement::while_end:
      return "while";
    case Statement::sub_begin:
      return "endsub";
    case Statement::sub_end:
      return "sub";
    default:
      return "";
  }
}

/// The steps up to and with `last`.
[[nodiscard]] constexpr StepSet steps_through(Step last) {
  return (Block::step_bit(last) << 1U) - 1;
}

}  // namespace

void Runner::go_behind(const FlowMark& mark) {
  cursor_ = {mark.line, mark.offset};
  static_cast<void>(program_->read(cursor_));
}

Accepted Runner::run_flow(const Line& line) {
  const FlowMark* mark = program_->flow().find(line_number_);
  const FlowMark* partner = mark == nullptr ? nullptr : program_->flow().partner_of(*mark);
  if (partner == nullptr) {
    return refuse(ErrorCode::flow_unmatched, {},
                  fmt::format("This line has no {}.", missing_partner(line.statement)),
                  "if ... else ... endif, while ... endwhile, sub ... endsub, properly nested.");
  }
  switch (line.statement) {
    case Statement::if_begin:
    case Statement::while_begin:
      return run_condition(line, partner);
    case Statement::if_else:
    case Statement::sub_begin:
      go_behind(*partner);
      return {};  // past the other branch, the sub
    case Statement::while_end:
      cursor_ = {partner->line, partner->offset};
      return {};
    case Statement::sub_end:
      return return_from_sub();
    default:
      return {};
  }
}

Accepted Runner::run_condition(const Line& line, const FlowMark* partner) {
  const auto complete = evaluate_line(line);
  if (!complete) return std::unexpected(complete.error());
  if (*complete && evaluation_.condition == 0.0) go_behind(*partner);
  return {};
}

Accepted Runner::run_gosub(const Line& line) {
  const Sources::Sub sub = sources_.find_sub(line.name);
  if (sub.begin != nullptr) return call(sub, line.name_span, -1, nullptr);
  return refuse(ErrorCode::sub_unknown, line.name_span,
                fmt::format("There is no sub {} in the program and the macro files.", line.name));
}

Accepted Runner::call(const Sources::Sub& sub, Span span, std::int32_t m_code,
                      std::unique_ptr<Rest> rest) {
  const Program& target = sources_.file(sub.file);
  if (sub.other_line != 0) {
    return refuse(ErrorCode::sub_duplicate, span,
                  fmt::format("This sub exists twice in {}: in lines {} and {}.", target.name(),
                              sub.begin->line, sub.other_line),
                  "One sub of a name.");
  }
  if (target.flow().partner_of(*sub.begin) == nullptr) {
    return refuse(
        ErrorCode::flow_unmatched, span,
        fmt::format("The sub in line {} of {} has no endsub.", sub.begin->line, target.name()));
  }
  if (calls_.size() >= settings_.max_call_depth) {
    return refuse(ErrorCode::calls_too_deep, span, "Too many gosubs within one another.",
                  fmt::format("At most {}.", settings_.max_call_depth));
  }
  calls_.push_back({file_, cursor_, line_number_, sub, m_code, std::move(rest)});
  names_.enter_sub();
  enter_file(sub.file);
  go_behind(*sub.begin);
  return {};
}

Accepted Runner::return_from_sub() {
  if (calls_.empty()) {
    return refuse(ErrorCode::endsub_without_call, {}, "This endsub was reached without a gosub.",
                  "A start outside of subs.");
  }
  Call& call = calls_.back();
  enter_file(call.file);
  cursor_ = call.return_to;
  rest_ = std::move(call.rest);
  line_number_ = call.line;
  if (rest_) line_text_ = program_->line(call.line);
  calls_.pop_back();
  names_.leave_sub();
  return {};
}

// --- subs in place of M codes (manual 4.3, 4.4)
// ----------------------------------------------------

bool Runner::is_running(std::int32_t m_code) const {
  return std::ranges::any_of(calls_, [&](const Call& call) { return call.m_code == m_code; });
}

std::optional<Sources::Sub> Runner::sub_instead_of_m(const Block& block) const {
  for (const std::int32_t number : block.m_numbers()) {
    std::array<char, 8> name{'M'};
    const auto end = fmt::format_to_n(name.data(), name.size(), "M{}", number).out;
    const Sources::Sub sub = sources_.find_sub({name.data(), end});
    if (sub.begin != nullptr && !is_running(number)) return sub;
  }
  return std::nullopt;
}

/// "There must be nothing else on the line": its words are the sub's, and mean nothing to the line.
Accepted Runner::call_instead_of_m(const Block& block, const Sources::Sub& sub) {
  constexpr StepSet kOwnWords = Block::step_bit(Step::comment) | Block::step_bit(Step::feed) |
                                Block::step_bit(Step::speed) | Block::step_bit(Step::tool);
  const StepSet others = block.steps() & ~kOwnWords;
  const bool has_one_code = (others & (others - 1)) == 0;
  const std::int32_t number = block.m_numbers().front();
  if (block.m_numbers().size() != 1 || !has_one_code || block.has_g_code()) {
    return refuse(ErrorCode::user_m_not_alone, block.m_span(),
                  fmt::format("M{} is a sub: no other code can stand on its line.", number),
                  "The M code and its words.");
  }
  if (Accepted called = call(sub, block.m_span(), number, nullptr); !called) return called;
  for (std::int32_t i = 0; i < kWordParameters; ++i) {
    const char letter = static_cast<char>('A' + i);
    execution_.set_now(i + 1, block.find(letter).value_or(kNotGiven));
  }
  return {};
}

std::optional<Sources::Sub> Runner::sub_for_tool_change(const Block& block) const {
  if (!block.has(Step::tool_change) || !settings_.automatic_tool_change) return std::nullopt;
  if (is_running(kToolChange)) return std::nullopt;
  const Sources::Sub sub = sources_.find_sub(kToolChangeSub);
  return sub.begin == nullptr ? std::nullopt : std::optional(sub);
}

/// What stands before M6 in the order of execution comes first, the rest when the sub is over.
Accepted Runner::call_for_tool_change(Block& block, const Sources::Sub& sub) {
  constexpr StepSet kBefore =
      steps_through(Step::tool_change) & ~Block::step_bit(Step::tool_change);
  auto rest = std::make_unique<Rest>();
  rest->block = block;
  rest->steps = block.steps() & ~steps_through(Step::tool_change);
  if (Accepted before = execution_.run(block, here(), block.steps() & kBefore); !before) {
    return before;
  }
  execution_.set_now(kNewTool, execution_.state().modal.selected_tool);
  return call(sub, block.span_of(Step::tool_change), kToolChange, std::move(rest));
}

// --- macro files
// -----------------------------------------------------------------------------------

void Runner::set_library(const Library& library) {
  stop();
  sources_.set_library(library);
  library_warnings_.clear();
  for (std::uint16_t file = Sources::kJob + 1; file < sources_.count(); ++file) initialise(file);
  stop();
}

/// Executes what stands outside of subs as far as it only sets parameters; everything else of it is
/// free text (real macro files have both), or code that must not run by itself.
void Runner::initialise(std::uint16_t file) {
  constexpr std::uint32_t kMaxLines = 100'000;
  enter_file(file);
  cursor_ = program_->begin_of(1);
  access_.set_live(true);
  for (std::uint32_t lines = 0; !program_->at_end(cursor_); ++lines) {
    line_number_ = cursor_.line;
    line_text_ = program_->read(cursor_);
    Accepted done = lines < kMaxLines
                        ? initialise_line()
                        : refuse(ErrorCode::check_incomplete, {},
                                 "The lines outside of subs run without end: given up here.");
    if (!done) note_library(done.error());
    if (lines >= kMaxLines) return;
  }
}

Accepted Runner::initialise_line() {
  Line& line = scratch_;
  const auto skip = [](Habit habit) { return refuse_habit(habit, {}); };
  if (!parse_line(line_text_, line)) return skip(Habit::text_outside_sub);
  if (steers(line.statement)) return run_flow(line);
  if (line.statement != Statement::block) return skip(Habit::code_outside_sub);
  line.block.drop_step(Step::comment);
  if (line.block.steps() != 0 || line.block.words() != 0 || !line.block.m_numbers().empty()) {
    return skip(Habit::code_outside_sub);
  }
  if (Accepted values = evaluate(line, access_, evaluation_); !values) return values;
  if (evaluation_.block.steps() != 0 || evaluation_.block.words() != 0)
    return skip(Habit::code_outside_sub);
  return execute(evaluation_.block, 0);
}

}  // namespace cnc::interp
