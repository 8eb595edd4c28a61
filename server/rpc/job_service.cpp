#include <algorithm>

#include "cnc/v1/job.grpc.pb.h"
#include "interpreter/statement_parser.h"
#include "server/rpc/host.h"
#include "server/rpc/utf8.h"

namespace cnc::server::rpc {
namespace {

constexpr std::uint32_t kMaxLinesPerCall = 1000;
constexpr std::size_t kMaxMdiLength = 4096;

class JobService final : public v1::Job::CallbackService {
 public:
  explicit JobService(Host& host) : host_(host) {}

  grpc::ServerUnaryReactor* Load(grpc::CallbackServerContext*, const v1::LoadRequest* request,
                                 v1::LoadResponse* response) override {
    auto* call = new UnaryCall;
    const auto path = std::filesystem::weakly_canonical(host_.job_folder / request->path());
    // Opening and indexing reads the whole file: not on the executor, which has motion to feed.
    host_.files.post([this, call, path, response] {
      auto program = interp::Program::open(path);
      if (!program) return call->Finish(to_status(program.error()));
      response->set_path(path);
      response->set_lines((*program)->line_count());
      response->set_bytes((*program)->size());
      host_.executor.post([this, call, path, program = std::move(*program)] {
        call->Finish(to_status(host_.machine.load(program, path)));
      });
    });
    return call;
  }

  grpc::ServerUnaryReactor* Run(grpc::CallbackServerContext*, const v1::RunRequest*,
                                v1::RunResponse*) override {
    return on_executor(host_, [](Machine& machine) { return machine.run(); });
  }

  grpc::ServerUnaryReactor* Pause(grpc::CallbackServerContext*, const v1::PauseRequest*,
                                  v1::PauseResponse*) override {
    return when_completed(
        host_, [](Machine& machine, Completion done) { machine.pause(std::move(done)); });
  }

  grpc::ServerUnaryReactor* Resume(grpc::CallbackServerContext*, const v1::ResumeRequest*,
                                   v1::ResumeResponse*) override {
    return on_executor(host_, [](Machine& machine) { return machine.resume(); });
  }

  grpc::ServerUnaryReactor* Stop(grpc::CallbackServerContext*, const v1::StopRequest*,
                                 v1::StopResponse*) override {
    return when_completed(host_,
                          [](Machine& machine, Completion done) { machine.stop(std::move(done)); });
  }

  grpc::ServerUnaryReactor* Rewind(grpc::CallbackServerContext*, const v1::RewindRequest*,
                                   v1::RewindResponse*) override {
    return on_executor(host_, [](Machine& machine) { return machine.rewind(); });
  }

  grpc::ServerUnaryReactor* Answer(grpc::CallbackServerContext*, const v1::AnswerRequest* request,
                                   v1::AnswerResponse*) override {
    return on_executor(host_, [request](Machine& machine) {
      return machine.answer(request->number(), request->confirmed(),
                            {request->values().begin(), request->values().end()});
    });
  }

  grpc::ServerUnaryReactor* RunSub(grpc::CallbackServerContext*, const v1::RunSubRequest* request,
                                   v1::RunSubResponse*) override {
    if (request->name().empty() || interp::leading_name(request->name()) != request->name())
      return answer(invalid_argument("The name of a sub has letters, digits and underscores."));
    return when_completed(
        host_,
        [name = request->name()](Machine& machine, Completion done) {
          machine.run_sub(name, std::move(done));
        },
        OnCancel::stop_machine);
  }

  grpc::ServerUnaryReactor* ReadLines(grpc::CallbackServerContext*,
                                      const v1::ReadLinesRequest* request,
                                      v1::ReadLinesResponse* response) override {
    if (request->first() == 0) return answer(invalid_argument("Lines are counted from 1."));
    if (request->count() == 0 || request->count() > kMaxLinesPerCall)
      return answer(invalid_argument("1 to 1000 lines can be read in one call."));
    return on_executor(host_, [request, response](Machine& machine) -> Result<void> {
      response->set_first(request->first());
      const auto program = machine.program();
      if (!program) return {};
      const std::uint64_t last =
          std::min<std::uint64_t>(program->line_count(), request->first() + request->count() - 1);
      for (std::uint64_t line = request->first(); line <= last; ++line)
        response->add_lines(valid_utf8(program->line(static_cast<std::uint32_t>(line))));
      return {};
    });
  }

  grpc::ServerUnaryReactor* GetProblems(grpc::CallbackServerContext*, const v1::GetProblemsRequest*,
                                        v1::GetProblemsResponse* response) override {
    return on_executor(host_, [response](Machine& machine) -> Result<void> {
      const auto findings = machine.findings();
      if (!findings) return {};
      response->set_complete(findings->report.complete);
      for (const auto* list : {&findings->report.errors, &findings->report.warnings})
        for (const interp::Diagnostic& diagnostic : *list)
          fill(diagnostic, *response->add_problems());
      if (findings->prediction.error && findings->report.errors.empty())
        *response->add_problems()->mutable_error() = to_proto(*findings->prediction.error);
      return {};
    });
  }

 private:
  static void fill(const interp::Diagnostic& diagnostic, v1::Problem& problem) {
    *problem.mutable_error() = to_proto(diagnostic.to_error());
    problem.set_line_text(valid_utf8(diagnostic.line_text));
    problem.set_length(diagnostic.length);
    problem.set_warning(diagnostic.severity == interp::Severity::warning);
    for (const interp::CallSite& call : diagnostic.call_stack) {
      v1::CallSite* site = problem.add_calls();
      site->set_sub(valid_utf8(call.sub));
      site->mutable_place()->set_file(call.file);
      site->mutable_place()->set_line(call.line);
    }
  }

  Host& host_;
};

class MdiService final : public v1::Mdi::CallbackService {
 public:
  explicit MdiService(Host& host) : host_(host) {}

  grpc::ServerUnaryReactor* Execute(grpc::CallbackServerContext*, const v1::ExecuteRequest* request,
                                    v1::ExecuteResponse*) override {
    if (request->line().empty() || request->line().size() > kMaxMdiLength)
      return answer(invalid_argument("A line has 1 to 4096 characters."));
    if (request->line().find_first_of("\n\r") != std::string::npos)
      return answer(invalid_argument("A single line has no line ends in it."));
    return when_completed(
        host_,
        [line = request->line()](Machine& machine, Completion done) {
          machine.mdi(line, std::move(done));
        },
        OnCancel::stop_machine);
  }

 private:
  Host& host_;
};

}  // namespace

std::unique_ptr<grpc::Service> make_job_service(Host& host) {
  return std::make_unique<JobService>(host);
}
std::unique_ptr<grpc::Service> make_mdi_service(Host& host) {
  return std::make_unique<MdiService>(host);
}

}  // namespace cnc::server::rpc
