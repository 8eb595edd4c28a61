#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "interpreter/check.h"
#include "server/cncsim/options.h"
#include "server/cncsim/watched_check.h"
#include "server/job/settings.h"

namespace cnc::server {
namespace {

/// Writes one canonical command per line.
class CanonFile {
 public:
  static Result<CanonFile> create(const std::filesystem::path& path) {
    std::FILE* file = std::fopen(path.c_str(), "w");
    if (file == nullptr)
      return fail(ErrorCode::file_not_writable,
                  fmt::format("Cannot write {}: {}.", path.string(), std::strerror(errno)));
    return CanonFile(path, file);
  }

  void add(const interp::Command& command) {
    interp::append_text(waiting_, command);
    waiting_ += '\n';
    if (waiting_.size() >= kWriteAtOnce) write();
  }

  Result<void> finish() {
    write();
    if (std::fflush(file_.get()) == 0 && std::ferror(file_.get()) == 0) return {};
    return fail(ErrorCode::file_not_writable,
                fmt::format("{} could not be written completely.", path_.string()));
  }

 private:
  static constexpr std::size_t kWriteAtOnce = 1U << 16U;

  CanonFile(std::filesystem::path path, std::FILE* file) : path_(std::move(path)), file_(file) {}

  void write() {
    std::fwrite(waiting_.data(), 1, waiting_.size(), file_.get());
    waiting_.clear();
  }

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::string waiting_;  ///< text that is not written yet
};

nlohmann::json json_of(const interp::Diagnostic& diagnostic) {
  return {{"code", static_cast<unsigned>(diagnostic.code)},
          {"name", error_info(diagnostic.code).name},
          {"message", diagnostic.sentence},
          {"allowed", diagnostic.allowed},
          {"line", diagnostic.line},
          {"column", diagnostic.column},
          {"length", diagnostic.length},
          {"text", diagnostic.line_text}};
}

nlohmann::json json_of(const Position& position) {
  nlohmann::json out;
  for (const Axis axis : kAllAxes) out[std::string(axis_name(axis))] = position[axis];
  return out;
}

void print_json(const CheckOptions& options, const interp::CheckReport& report) {
  nlohmann::json out{{"file", options.file.string()},     {"good", report.ok()},
                     {"complete", report.complete},       {"interrupted", report.cancelled},
                     {"lines", report.line_count},        {"commands", report.commands},
                     {"errors", nlohmann::json::array()}, {"warnings", nlohmann::json::array()}};
  for (const auto& error : report.errors) out["errors"].push_back(json_of(error));
  for (const auto& warning : report.warnings) out["warnings"].push_back(json_of(warning));
  if (!report.motion.empty) {
    out["min"] = json_of(report.motion.lowest);
    out["max"] = json_of(report.motion.highest);
  }
  // A file in another encoding must not end the report.
  fmt::print("{}\n", out.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

[[nodiscard]] const char* how_it_ended(const interp::CheckReport& report) {
  if (report.cancelled) return "; interrupted";
  return report.complete ? "" : "; the end was not reached";
}

void print_text(const interp::CheckReport& report) {
  for (const auto* list : {&report.errors, &report.warnings})
    for (const interp::Diagnostic& diagnostic : *list) fmt::print("{}\n", diagnostic.to_string());
  fmt::print("{} lines, {} errors, {} warnings{}\n", report.line_count, report.errors.size(),
             report.warnings.size(), how_it_ended(report));
  if (report.motion.empty) return;
  for (const Axis axis : kAllAxes)
    if (report.motion.lowest[axis] != report.motion.highest[axis])
      fmt::print("{}  {:12.4f} … {:12.4f}\n", axis_name(axis), report.motion.lowest[axis],
                 report.motion.highest[axis]);
}

/// Checks with Ctrl-C and progress.
interp::CheckReport watched_check(const CheckOptions& options, const MachineData& data,
                                  std::shared_ptr<const interp::Program> program,
                                  interp::CheckOptions check_options) {
  const Interrupt interrupt;
  ProgressLine line(program->line_count());
  check_options.cancel = &Interrupt::asked();
  if (options.progress || ProgressLine::is_terminal())
    check_options.progress = [&](const interp::CheckProgress& progress) { line.show(progress); };
  return interp::check(std::move(program), interpreter_settings(data.config, data.macros),
                       data.parameters, data.tools, Position{}, check_options);
}

}  // namespace

ExitCode check_command(const CheckOptions& options) {
  auto data = load_machine(options);
  if (!data) return refuse(data.error());
  auto program = interp::Program::open(options.file);
  if (!program) return refuse(program.error());

  interp::CheckOptions check_options;
  check_options.max_errors = options.max_errors;
  check_options.max_loop_lines = options.max_loop_lines;
  std::optional<CanonFile> canon;
  if (!options.canon.empty()) {
    auto created = CanonFile::create(options.canon);
    if (!created) return refuse(created.error());
    canon.emplace(std::move(*created));
    check_options.sink = [&](const interp::Command& command) { canon->add(command); };
  }

  const interp::CheckReport report = watched_check(options, *data, *program, check_options);
  if (canon)
    if (auto finished = canon->finish(); !finished) return refuse(finished.error());
  if (options.json)
    print_json(options, report);
  else
    print_text(report);
  return report.ok() ? kGood : kProgramFailed;
}

}  // namespace cnc::server
