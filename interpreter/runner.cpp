#include "interpreter/runner.h"

#include <fmt/format.h>
#include <ranges>

#include "interpreter/check_block.h"
#include "interpreter/line_parser.h"
#include "interpreter/number_scan.h"

namespace cnc::interp {
namespace {

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
    case Statement::block:
    case Statement::gosub:
    case Statement::message:
      break;
  }
  return "";
}

}  // namespace

Runner::Runner(const InterpreterSettings& settings, config::ParameterStore& parameters,
               config::ToolTable& tools)
    : settings_(settings),
      execution_(settings_, parameters, tools),
      access_(settings_, parameters, tools, execution_.state()) {
  reset();
}

// --- program control
// -------------------------------------------------------------------------------

void Runner::reset() {
  stop();
  MachineState& state = execution_.state();
  const Position position = state.position;
  const std::int32_t tool = state.modal.tool;  // a reset takes no tool out of the spindle
  state = MachineState{};
  state.position = position;
  state.modal.tool = tool;
  state.modal.unit = settings_.default_unit;
  if (settings_.absolute_arc_centres) state.modal.arc_distance = DistanceMode::absolute;
  state.modal.work_system = execution_.parameters().active_system();
  state.coordinates.set_work_offset(execution_.parameters().work_offset(state.modal.work_system));
}

void Runner::start(std::shared_ptr<const Program> program, const Position& position,
                   const StartOptions& options) {
  stop();
  program_ = std::move(program);
  mode_ = options.mode;
  access_.set_live(mode_ != RunMode::run);
  cursor_ = program_->begin_of(options.line);
  line_number_ = cursor_.line;
  execution_.state().position = position;
  execution_.begin({0, line_number_});
  // The operator may have changed offsets and tools since the last program.
  execution_.reload_offsets();
  execution_.reload_tool_length();
}

void Runner::stop() {
  program_.reset();
  calls_.clear();
  cache_.clear();
  execution_.commands().clear();
  execution_.forget_steps();
  taken_ = 0;
  waits_ = false;
  runs_again_ = false;
  fails_after_commands_.reset();
  failed_ = false;
  ran_off_end_ = false;
  lines_run_ = 0;
}

bool Runner::skip_failed_line() {
  if (!failed_) return false;
  failed_ = false;
  fails_after_commands_.reset();
  execution_.forget_steps();
  return true;
}

Progress Runner::next() {
  std::vector<Command>& commands = execution_.commands();
  if (waits_) {
    if (mode_ == RunMode::run) return Progress::waiting;
    answer(expected_answer());
  }
  for (std::uint32_t lines = 0;; ++lines) {
    if (taken_ < commands.size()) return hand_out();
    if (failed_) return Progress::failed;
    if (fails_after_commands_) return fail(*fails_after_commands_);
    commands.clear();
    taken_ = 0;
    if (!program_ || execution_.program_ended()) return Progress::ended;
    if (lines == settings_.lines_per_call) return Progress::working;
    const bool in_line = execution_.steps_left() != 0;
    if (Accepted done = in_line ? run_rest_of_line() : run_line(); !done) return fail(done.error());
  }
}

Progress Runner::hand_out() {
  waits_ = waits_for_answer(execution_.commands()[taken_++].body);
  return Progress::command;
}

void Runner::answer(const Answer& answer) {
  if (!std::exchange(waits_, false)) return;
  execution_.take(answer, command().body);
  if (std::holds_alternative<Synchronise>(command().body)) access_.set_live(true);
}

Answer Runner::expected_answer() const { return execution_.expected_answer(command().body); }

const Command& Runner::command() const {
  static const Command kNone{ProgramEnd{}, {}};
  return taken_ == 0 ? kNone : execution_.commands()[taken_ - 1];
}

Progress Runner::fail(const Refusal& refusal) {
  failed_ = true;
  diagnostic_ = {.code = refusal.code,
                 .severity = Severity::error,
                 .sentence = refusal.sentence,
                 .allowed = refusal.allowed,
                 .file = program_->name(),
                 .line = line_number_,
                 .column = refusal.span.column,
                 .length = refusal.span.length,
                 .line_text = std::string(line_text_.substr(0, kMaxLineLength)),
                 .call_stack = {}};
  for (const Call& call : calls_ | std::views::reverse) {
    diagnostic_.call_stack.push_back({std::string(call.sub), call.line});
  }
  return Progress::failed;
}

// --- one line
// --------------------------------------------------------------------------------------

Accepted Runner::run_rest_of_line() {
  return execution_.run(*block_, here(), execution_.steps_left());
}

Accepted Runner::run_line() {
  if (std::exchange(runs_again_, false)) {
    Accepted done = run_parsed(*line_);
    access_.set_live(mode_ != RunMode::run);
    return done;
  }
  if (program_->at_end(cursor_)) {
    end_at_end_of_file();
    return {};
  }
  ++lines_run_;
  line_number_ = cursor_.line;
  line_text_ = program_->read(cursor_);
  if (settings_.block_delete && is_skipped()) return {};
  const auto line = parsed_line();
  if (!line) return std::unexpected(line.error());
  line_ = *line;
  return run_parsed(*line_);
}

/// Asks the world, and has the line run again when it has answered.
void Runner::ask_for_live_values() {
  execution_.begin(here());
  execution_.emit(Synchronise{});
  runs_again_ = true;
}

// The end of the file ends a program without resetting modes: a line typed by the operator is a
// program too, and must not switch off the spindle.
void Runner::end_at_end_of_file() {
  ran_off_end_ = true;
  line_number_ = program_->line_count();
  execution_.begin({0, line_number_});
  execution_.emit(ProgramEnd{});
  execution_.end_program();
}

bool Runner::is_skipped() const {
  const std::size_t first = line_text_.find_first_not_of(" \t\r");
  return first != std::string_view::npos && line_text_[first] == '/' &&
         program_->flow().find(line_number_) == nullptr;
}

Parsed<const Line*> Runner::parsed_line() {
  if (const Line* kept = cache_.find(line_number_)) return kept;
  const bool keep = !calls_.empty() || cache_.has_run(line_number_);
  Line& line = keep ? cache_.slot_for(line_number_) : scratch_;
  if (Accepted parsed = parse_line(line_text_, line); !parsed) {
    return std::unexpected(std::move(parsed.error()));
  }
  if (keep) cache_.keep(line_number_);
  return &line;
}

Accepted Runner::run_parsed(const Line& line) {
  switch (line.statement) {
    case Statement::block:
      return run_block(line);
    case Statement::gosub:
      return call_sub(line);
    case Statement::message:
      return show_text(line);
    case Statement::if_begin:
    case Statement::if_else:
    case Statement::if_end:
    case Statement::while_begin:
    case Statement::while_end:
    case Statement::sub_begin:
    case Statement::sub_end:
      break;
  }
  return run_flow(line);
}

Accepted Runner::run_block(const Line& line) {
  // Checking completes the block, so a kept line is copied; the usual line is used where it is.
  if (&line == &scratch_ && line.code.empty()) return check_and_execute(scratch_.block);
  if (Accepted values = evaluate(line, access_, evaluation_); !values) return values;
  if (access_.take_wants_live()) {
    ask_for_live_values();
    return {};
  }
  return check_and_execute(evaluation_.block);
}

Accepted Runner::check_and_execute(Block& block) {
  if (block.empty()) return {};
  if (Accepted allowed = check_block(block, execution_.state().modal); !allowed) return allowed;
  block_ = &block;
  return execution_.run(block, here(), block.steps());
}

// --- flow
// ------------------------------------------------------------------------------------------

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
    case Statement::if_end:
    case Statement::block:
    case Statement::gosub:
    case Statement::message:
      break;
  }
  return {};
}

Accepted Runner::run_condition(const Line& line, const FlowMark* partner) {
  if (Accepted value = evaluate(line, access_, evaluation_); !value) return value;
  if (access_.take_wants_live()) {
    ask_for_live_values();
    return {};
  }
  if (evaluation_.condition == 0.0) go_behind(*partner);
  return {};
}

Accepted Runner::call_sub(const Line& line) {
  const FlowIndex::Sub sub = program_->flow().find_sub(line.name);
  if (sub.mark == nullptr) {
    return refuse(ErrorCode::sub_unknown, line.name_span,
                  fmt::format("There is no sub {} in this program.", line.name));
  }
  if (sub.other_line != 0) {
    return refuse(ErrorCode::sub_duplicate, line.name_span,
                  fmt::format("The sub {} exists twice: in lines {} and {}.", line.name,
                              sub.mark->line, sub.other_line),
                  "One sub of a name.");
  }
  if (program_->flow().partner_of(*sub.mark) == nullptr) {
    return refuse(ErrorCode::flow_unmatched, line.name_span,
                  fmt::format("The sub {} in line {} has no endsub.", line.name, sub.mark->line));
  }
  if (calls_.size() >= settings_.max_call_depth) {
    return refuse(ErrorCode::calls_too_deep, line.name_span, "Too many gosubs within one another.",
                  fmt::format("At most {}.", settings_.max_call_depth));
  }
  calls_.push_back({cursor_, line_number_, line.name});
  go_behind(*sub.mark);
  return {};
}

Accepted Runner::return_from_sub() {
  if (calls_.empty()) {
    return refuse(ErrorCode::endsub_without_call, {}, "This endsub was reached without a gosub.",
                  "A start outside of subs.");
  }
  cursor_ = calls_.back().return_to;
  calls_.pop_back();
  return {};
}

// --- texts
// -----------------------------------------------------------------------------------------

Accepted Runner::show_text(const Line& line) {
  if (Accepted text = evaluate(line, access_, evaluation_); !text) return text;
  if (access_.take_wants_live()) {
    ask_for_live_values();
    return {};
  }
  execution_.begin(here());
  execution_.emit(Message{line.text_kind, evaluation_.text});
  if (line.text_kind == MessageKind::warning) {
    execution_.emit(ProgramStop{StopKind::program_stop});
  }
  if (line.text_kind == MessageKind::error) {
    fails_after_commands_ = Refusal{ErrorCode::program_raised_error, {}, evaluation_.text, {}};
  }
  return {};
}

}  // namespace cnc::interp
