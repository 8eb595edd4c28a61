#include "interpreter/runner.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "interpreter/check_block.h"
#include "interpreter/line_parser.h"
#include "interpreter/number_scan.h"

namespace cnc::interp {
namespace {

[[nodiscard]] bool is_same_place(const Position& one, const Position& other) {
  constexpr double kInPlace = 1e-3;  // mm or degrees
  return std::ranges::all_of(
      kAllAxes, [&](Axis axis) { return std::abs(one[axis] - other[axis]) <= kInPlace; });
}

/// M84 of slicers switches the motors off at the end of a print: no spindle is meant.
[[nodiscard]] bool is_ignored_by_printers(const Block& block) {
  constexpr std::int32_t kMotorsOff = 84;
  return block.unknown_m() ||
         std::ranges::find(block.m_numbers(), kMotorsOff) != block.m_numbers().end();
}

/// E is the A axis of a 3D printer (manual 2.11), but where a code of the line has an E of its own.
Accepted read_extruder_axis(Block& block) {
  if (!block.has('E')) return {};
  for (StepSet steps = block.steps(); steps != 0; steps &= steps - 1) {
    const Code& code = block.code(Step{static_cast<std::uint8_t>(std::countr_zero(steps))});
    if ((code.uses & word_bit('E')) != 0) return {};
  }
  return block.rename_word('E', 'A');
}

}  // namespace

Runner::Runner(const InterpreterSettings& settings, config::ParameterStore& parameters,
               config::ToolTable& tools)
    : settings_(settings),
      execution_(settings_, parameters, tools, names_),
      access_(settings_, parameters, tools, names_, execution_.state()) {
  prepare(scratch_);
  reset();
  set_library(settings_.library);
}

// --- program control
// -------------------------------------------------------------------------------

/// For the language that is read. The manual knows no names.
void Runner::prepare(Line& line) {
  line.block.set_dialect(dialect(settings_.dialect));
  line.names = dialect(settings_.dialect).has_names && !settings_.strict ? &names_ : nullptr;
}

void Runner::reset() {
  stop();
  MachineState& state = execution_.state();
  const Position position = state.position;
  const ModalState before = state.modal;
  state = MachineState{};
  state.position = position;
  state.modal.tool = before.tool;  // a reset takes no tool out of the spindle and opens no brake
  state.modal.a_clamped = before.a_clamped;
  state.modal.clamp_port = before.clamp_port;
  state.modal.unit = settings_.default_unit;
  state.diameter_programming = settings_.diameter_programming;
  if (settings_.absolute_arc_centres) state.modal.arc_distance = DistanceMode::absolute;
  state.modal.work_system = execution_.parameters().active_system();
  state.coordinates.set_work_offset(execution_.parameters().work_offset(state.modal.work_system));
}

void Runner::start(std::shared_ptr<const Program> program, const Position& position,
                   const StartOptions& options) {
  stop();
  sources_.set_job(std::move(program));
  enter_file(Sources::kJob);
  mode_ = options.mode;
  single_line_ = options.single_line;
  search_line_ = options.mode == RunMode::search ? options.search_line : 0;
  searched_ = position;
  searched_feed_ = {execution_.state().modal.feed_mode, execution_.state().modal.feed};
  access_.set_live(mode_ != RunMode::run);
  cursor_ = program_->begin_of(options.line);
  line_number_ = cursor_.line;
  execution_.state().arrive(position);
  execution_.state().rendering = mode_ != RunMode::run;
  execution_.begin(here());
  // The operator may have changed offsets and tools since the last program.
  execution_.reload_offsets();
  execution_.reload_tool_length();
}

// How far the last move of a compensated contour goes only the next one tells (an inside corner
// shortens it). So the program goes on with it, from where it starts: there the tool is on its
// path.
ResumePoint Runner::resume_point() const {
  const MachineState& state = execution_.state();
  ResumePoint point{.line = cursor_.line,
                    .position = state.machine_position(),
                    .work_position = state.work_position(),
                    .modal = state.modal,
                    .work_offset = state.coordinates.work_offset(),
                    .g92_offset = state.coordinates.g92_offset(),
                    .tool_length = state.coordinates.tool_length(),
                    .head_offset = state.coordinates.head_offset()};
  if (!state.compensation.held) return point;
  point.position = searched_;
  point.work_position = state.coordinates.to_work(searched_);
  point.modal.feed_mode = searched_feed_.mode;
  point.modal.feed = searched_feed_.feed;
  return point;
}

void Runner::leave_search(const Position& position) {
  mode_ = RunMode::run;
  search_line_ = 0;
  access_.set_live(false);
  MachineState& state = execution_.state();
  state.rendering = false;
  if (state.compensation.held && is_same_place(position, searched_)) return;
  execution_.release_held();
  execution_.drop_commands(0);
  state.arrive(position);
}

void Runner::stop() {
  program_ = nullptr;
  line_ = nullptr;
  calls_.clear();
  cache_.clear();
  names_.forget_locals();
  execution_.release_held();
  execution_.commands().clear();
  execution_.forget_steps();
  taken_ = 0;
  waits_ = false;
  runs_again_ = false;
  fails_after_commands_.reset();
  failed_ = false;
  ran_off_end_ = false;
  end_was_missed_ = false;
  lines_run_ = 0;
  lines_since_new_ = 0;
  habits_seen_.reset();
  warnings_.clear();
}

bool Runner::skip_failed_line() {
  if (!failed_) return false;
  failed_ = false;
  execution_.release_held();
  execution_.forget_steps();
  // The lines behind rely on the modes and the end point of this one: without these a single
  // mistake would be told once per line.
  if (!std::exchange(fails_after_commands_, std::nullopt) && line_ != nullptr) assume_done(*line_);
  return true;
}

void Runner::assume_done(const Line& line) {
  if (line.statement != Statement::block) return;
  static_cast<void>(evaluate(line, access_, evaluation_));  // as far as it can be
  static_cast<void>(access_.take_wants_live());
  execution_.assume_done(evaluation_.block, here());
}

void Runner::enter_file(std::uint16_t file) {
  file_ = file;
  program_ = &sources_.file(file);
}

Progress Runner::next() {
  for (std::uint32_t lines = 0;; ++lines) {
    if (waits_) {
      if (mode_ == RunMode::run) return Progress::waiting;
      answer(expected_answer());
    }
    if (taken_ < execution_.ready_count()) {
      hand_out();
      if (mode_ == RunMode::search) {
        pass_by(command().body);
        continue;
      }
      return Progress::command;
    }
    if (failed_) return Progress::failed;
    if (fails_after_commands_) return fail(*fails_after_commands_);
    execution_.drop_commands(std::exchange(taken_, 0));
    if (program_ == nullptr || execution_.program_ended()) return Progress::ended;
    if (lines >= settings_.lines_per_call) return Progress::working;
    const bool in_line = execution_.steps_left() != 0;
    if (search_line_ != 0 && !in_line && search_is_over()) return Progress::found;
    if (Accepted done = in_line ? run_rest_of_line() : run_line(); !done) return fail(done.error());
  }
}

void Runner::hand_out() { waits_ = waits_for_answer(execution_.commands()[taken_++].body); }

void Runner::pass_by(const CommandBody& command) {
  if (const Position* end = end_of(command)) searched_ = *end;
  if (const auto* feed = std::get_if<SetFeedRate>(&command)) searched_feed_ = *feed;
}

/// A line that is never reached (in a branch that is not taken) is found at the next one.
bool Runner::search_is_over() const {
  if (file_ != Sources::kJob || rest_ != nullptr) return false;
  return cursor_.line == search_line_ || (calls_.empty() && cursor_.line > search_line_);
}

const Command& Runner::command() const {
  static const Command kNone{ProgramEnd{}, {}};
  return taken_ == 0 ? kNone : execution_.commands()[taken_ - 1];
}

void Runner::answer(const Answer& answer) {
  if (!std::exchange(waits_, false)) return;
  if (Accepted possible = execution_.check(answer, command().body); !possible) {
    // Going on would mean moving from where nobody knows, or with values that nobody gave.
    fails_after_commands_ = std::move(possible.error());
    return;
  }
  execution_.take(answer, command().body);
  if (std::holds_alternative<Synchronise>(command().body)) access_.set_live(true);
}

std::optional<Error> Runner::refusal_of(const Answer& answer) const {
  if (!waits_) return std::nullopt;
  const Accepted possible = execution_.check(answer, command().body);
  if (possible) return std::nullopt;
  return diagnostic_of(possible.error(), Severity::error).to_error();
}

Answer Runner::expected_answer() const { return execution_.expected_answer(command().body); }

// --- one line
// --------------------------------------------------------------------------------------

Accepted Runner::run_line() {
  if (std::exchange(runs_again_, false)) return run_again();
  if (rest_) return run_rest_of_line();
  if (program_->at_end(cursor_)) return end_at_end_of_file();
  ++lines_run_;
  line_number_ = cursor_.line;
  line_text_ = program_->read(cursor_);
  if (settings_.block_delete && is_skipped()) return {};
  const auto line = parsed_line();
  if (!line) return line_text_.contains('\0') ? refuse_truncated() : std::unexpected(line.error());
  return run_parsed(**line);
}

Accepted Runner::run_again() {
  Accepted done = run_parsed(*line_);
  access_.set_live(mode_ != RunMode::run);
  return done;
}

/// Behind a command that has been answered, or behind a sub that was called within the line.
Accepted Runner::run_rest_of_line() {
  if (execution_.steps_left() != 0) return execution_.run(*block_, here(), execution_.steps_left());
  const std::unique_ptr<Rest> rest = std::move(rest_);
  evaluation_.block = rest->block;
  return execute(evaluation_.block, rest->steps);
}

// The end of the file ends a program without resetting modes: a line typed by the operator is a
// program too, and must not switch off the spindle. A missing M30 is an error once, so that a
// check, which goes on behind errors, comes to its end.
Accepted Runner::end_at_end_of_file() {
  line_ = nullptr;
  const bool misses_end =
      dialect(settings_.dialect).needs_end && !single_line_ && !execution_.stopped_last();
  if (misses_end && !std::exchange(end_was_missed_, true)) {
    line_text_ = {};
    return refuse(ErrorCode::no_program_end, {0, 1}, "The program does not end with M00 or M30.",
                  "M00 or M30 on the last line.");
  }
  line_number_ = program_->line_count();
  if (program_->was_truncated()) return refuse_truncated();
  ran_off_end_ = true;
  execution_.begin(here());
  execution_.emit(ProgramEnd{});
  execution_.end_program();
  return {};
}

Accepted Runner::refuse_truncated() {
  line_ = nullptr;
  line_text_ = {};
  return refuse(
      ErrorCode::program_truncated, {0, 1},
      fmt::format("{} became shorter while it ran: this line is missing.", file_name(file_)),
      "A file that nobody writes to until the job is over.");
}

bool Runner::is_skipped() const {
  const std::size_t first = line_text_.find_first_not_of(" \t\r");
  return first != std::string_view::npos && line_text_[first] == '/' &&
         program_->flow().find(line_number_) == nullptr;
}

Parsed<const Line*> Runner::parsed_line() {
  const LineCache::Key key = LineCache::key_of(file_, line_number_);
  ++lines_since_new_;
  if (const Line* kept = cache_.find(key)) return line_ = kept;
  const bool keep = !calls_.empty() || cache_.has_run(line_number_);
  if (!keep) lines_since_new_ = 0;
  Line& line = keep ? cache_.slot_for(key) : scratch_;
  if (keep) prepare(line);
  line_ = &line;
  if (Accepted parsed = parse_line(line_text_, line); !parsed) {
    return std::unexpected(std::move(parsed.error()));
  }
  if (keep) cache_.keep(key);
  return line_;
}

Accepted Runner::run_parsed(const Line& line) {
  if (line.statement == Statement::block) return run_block(line);
  if (line.block.habit() != Habit::none) {
    Accepted tolerated = tolerate(line.block.habit(), line.block.habit_span());
    if (!tolerated) return tolerated;
  }
  switch (line.statement) {
    case Statement::gosub:
      return run_gosub(line);
    case Statement::message:
      return show_text(line);
    case Statement::special:
      return run_special(line);
    case Statement::block:
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

Parsed<bool> Runner::evaluate_line(const Line& line) {
  if (Accepted done = evaluate(line, access_, evaluation_); !done) {
    return std::unexpected(std::move(done.error()));
  }
  if (!access_.take_wants_live()) return true;
  execution_.begin(here());
  execution_.emit(Synchronise{});
  runs_again_ = true;
  return false;
}

Accepted Runner::run_block(const Line& line) {
  // Checking completes the block, so a kept line is copied; the usual line is used where it is.
  if (&line == &scratch_ && line.code.empty()) return start_block(scratch_.block);
  const auto complete = evaluate_line(line);
  if (!complete) return std::unexpected(complete.error());
  return *complete ? start_block(evaluation_.block) : Accepted{};
}

Accepted Runner::start_block(Block& block) {
  if (block.empty()) {
    return block.habit() == Habit::none ? Accepted{} : tolerate(block.habit(), block.habit_span());
  }
  if (!block.m_numbers().empty()) {
    if (const auto sub = sub_instead_of_m(block)) return call_instead_of_m(block, *sub);
    if (settings_.is_3d_printer && is_ignored_by_printers(block)) {
      return tolerate(Habit::ignored_code, block.m_span());
    }
    if (const auto unknown = block.unknown_m()) {
      return block.refuse_m_code(*unknown, block.m_span());
    }
  }
  if (settings_.is_3d_printer) {
    if (Accepted read = read_extruder_axis(block); !read) return read;
  }
  if (Accepted allowed = check_block(block, execution_.state().modal); !allowed) return allowed;
  if (block.habit() != Habit::none) {
    Accepted tolerated = tolerate(block.habit(), block.habit_span());
    if (!tolerated) return tolerated;
  }
  if (const auto sub = sub_for_tool_change(block)) return call_for_tool_change(block, *sub);
  return execute(block, block.steps());
}

Accepted Runner::execute(Block& block, StepSet steps) {
  block_ = &block;
  Accepted done = execution_.run(block, here(), steps);
  if (execution_.habit() == Habit::none || !done) return done;
  return tolerate(execution_.habit(), execution_.habit_span());
}

Accepted Runner::run_special(const Line& line) {
  const auto complete = evaluate_line(line);
  if (!complete) return std::unexpected(complete.error());
  if (!*complete) return {};
  execution_.begin(here());
  return line.special->handler(execution_, evaluation_.arguments);
}

Accepted Runner::show_text(const Line& line) {
  const auto complete = evaluate_line(line);
  if (!complete) return std::unexpected(complete.error());
  if (!*complete) return {};
  execution_.begin(here());
  execution_.release_held();  // the text lives only until the next line
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
