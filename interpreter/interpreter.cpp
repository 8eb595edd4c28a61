// The public face: program control. runner.h reads and runs the lines.
#include "interpreter/interpreter.h"

#include "interpreter/runner.h"

namespace cnc::interp {

struct Interpreter::Impl {
  Impl(const InterpreterSettings& settings, config::ParameterStore& parameters,
       config::ToolTable& tools)
      : runner(settings, parameters, tools) {}

  Runner runner;
};

Interpreter::Interpreter(const InterpreterSettings& settings, config::ParameterStore& parameters,
                         config::ToolTable& tools)
    : impl_(std::make_unique<Impl>(settings, parameters, tools)) {}
Interpreter::~Interpreter() = default;

void Interpreter::start(std::shared_ptr<const Program> program, const Position& machine_position,
                        const StartOptions& options) {
  impl_->runner.start(std::move(program), machine_position, options);
}

ResumePoint Interpreter::resume_point() const { return impl_->runner.resume_point(); }

void Interpreter::leave_search(const Position& machine_position) {
  impl_->runner.leave_search(machine_position);
}
void Interpreter::set_library(const Library& library) { impl_->runner.set_library(library); }
const std::vector<Diagnostic>& Interpreter::library_warnings() const {
  return impl_->runner.library_warnings();
}
const std::vector<Diagnostic>& Interpreter::warnings() const { return impl_->runner.warnings(); }
std::string_view Interpreter::file_name(std::uint16_t file) const {
  return impl_->runner.file_name(file);
}

void Interpreter::stop() { impl_->runner.stop(); }
void Interpreter::reset() { impl_->runner.reset(); }
Progress Interpreter::next() { return impl_->runner.next(); }
const Command& Interpreter::command() const { return impl_->runner.command(); }
void Interpreter::answer(const Answer& answer) { impl_->runner.answer(answer); }
std::optional<Error> Interpreter::refusal_of(const Answer& answer) const {
  return impl_->runner.refusal_of(answer);
}
void Interpreter::cancel_cutter_compensation() { impl_->runner.cancel_cutter_compensation(); }
Answer Interpreter::expected_answer() const { return impl_->runner.expected_answer(); }
const Diagnostic& Interpreter::diagnostic() const { return impl_->runner.diagnostic(); }
bool Interpreter::skip_failed_line() { return impl_->runner.skip_failed_line(); }

Position Interpreter::position() const { return impl_->runner.state().machine_position(); }
void Interpreter::set_position(const Position& machine_position) {
  impl_->runner.state().arrive(machine_position);
}
const ModalState& Interpreter::modal() const { return impl_->runner.state().modal; }
const MachineState& Interpreter::state() const { return impl_->runner.state(); }
void Interpreter::set_state(const MachineState& state) { impl_->runner.state() = state; }
void Interpreter::set_block_delete(bool on) { impl_->runner.set_block_delete(on); }
void Interpreter::set_tool_in_spindle(std::int32_t tool) {
  impl_->runner.state().modal.tool = config::ToolTable::is_valid(tool) ? tool : 0;
}
Position Interpreter::total_offset() const { return impl_->runner.state().coordinates.total(); }
Position Interpreter::to_work(const Position& machine) const {
  const MachineState& state = impl_->runner.state();
  Position work = state.coordinates.to_work(machine);
  if (state.diameter_programming) work[Axis::X] *= 2.0;
  return work;
}
std::uint32_t Interpreter::next_line() const { return impl_->runner.next_line(); }
std::uint64_t Interpreter::lines_run() const { return impl_->runner.lines_run(); }
std::uint64_t Interpreter::lines_since_new() const { return impl_->runner.lines_since_new(); }
bool Interpreter::ran_off_end() const { return impl_->runner.ran_off_end(); }

}  // namespace cnc::interp
