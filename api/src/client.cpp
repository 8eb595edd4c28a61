// One function per call: fill the request, make the call, take the answer apart.
#include "api/client.h"

#include <utility>

#include "api/src/connection.h"
#include "api/src/convert.h"
#include "api/src/jog_session.h"
#include "api/src/subscription.h"

namespace cnc::api {
namespace {

/// For calls whose answer says nothing more than "done".
template <typename Response>
Result<void> done(const Result<Response>& response) {
  if (!response) return std::unexpected(response.error());
  return {};
}

/// The answer as the plain type of the public headers.
template <typename Response>
auto converted(const Result<Response>& response) -> Result<decltype(from_wire(*response))> {
  if (!response) return std::unexpected(response.error());
  return from_wire(*response);
}

}  // namespace

Client::Client(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;
Client::~Client() = default;

Result<Client> Client::connect(const std::string& address, const ClientOptions& options) {
  Client client = without_connecting(address, options);
  const auto version = client.impl_->check_version(options.connect_timeout);
  if (!version) return std::unexpected(version.error());
  return client;
}

Client Client::without_connecting(const std::string& address, const ClientOptions& options) {
  return Client(std::make_shared<Impl>(address, options));
}

const std::string& Client::address() const { return impl_->address; }

bool Client::is_local() const { return impl_->address.starts_with("unix:"); }

Result<ServerVersion> Client::version() const {
  return converted(impl_->call(*impl_->system, &v1::System::Stub::GetVersion,
                               v1::GetVersionRequest(), impl_->options.call_timeout));
}

Result<Machine> Client::machine() const {
  return converted(impl_->call(*impl_->system, &v1::System::Stub::GetMachine,
                               v1::GetMachineRequest(), impl_->options.call_timeout));
}

Result<LinkStatistics> Client::link_statistics(bool reset) const {
  v1::GetLinkStatisticsRequest request;
  request.set_reset(reset);
  return converted(impl_->call(*impl_->system, &v1::System::Stub::GetLinkStatistics, request,
                               impl_->options.call_timeout));
}

Result<std::string> Client::save_link_trace() const {
  const auto saved = impl_->call(*impl_->system, &v1::System::Stub::SaveLinkTrace,
                                 v1::SaveLinkTraceRequest(), impl_->options.call_timeout);
  if (!saved) return std::unexpected(saved.error());
  return saved->path();
}

Result<MachineStatus> Client::status() const {
  return converted(impl_->call(*impl_->status, &v1::Status::Stub::Get, v1::GetStatusRequest(),
                               impl_->options.call_timeout));
}

Subscription Client::subscribe_status(const StatusOptions& options, OnStatus on_status,
                                      OnConnectionChange on_connection_change) const {
  return make_status_subscription(impl_, options, std::move(on_status),
                                  std::move(on_connection_change));
}

Result<void> Client::reset() const {
  return done(impl_->call(*impl_->motion, &v1::Motion::Stub::Reset, v1::ResetRequest(),
                          impl_->options.call_timeout));
}

Result<void> Client::home(const std::vector<Axis>& axes, std::stop_token stop) const {
  v1::HomeRequest request;
  for (const Axis axis : axes) request.add_axes(to_wire(axis));
  return done(impl_->call(*impl_->homing, &v1::Homing::Stub::Home, request,
                          impl_->options.motion_timeout, std::move(stop)));
}

Result<void> Client::mdi(std::string_view line, std::stop_token stop) const {
  v1::ExecuteRequest request;
  request.set_line(std::string(line));
  return done(impl_->call(*impl_->mdi, &v1::Mdi::Stub::Execute, request,
                          impl_->options.motion_timeout, std::move(stop)));
}

Result<void> Client::run_sub(std::string_view name, std::stop_token stop) const {
  v1::RunSubRequest request;
  request.set_name(std::string(name));
  return done(impl_->call(*impl_->job, &v1::Job::Stub::RunSub, request,
                          impl_->options.motion_timeout, std::move(stop)));
}

Result<Overrides> Client::set_overrides(const OverrideChange& change) const {
  v1::SetOverridesRequest request;
  if (change.feed) request.set_feed(*change.feed);
  if (change.rapid) request.set_rapid(*change.rapid);
  if (change.speed) request.set_speed(*change.speed);
  const auto response = impl_->call(*impl_->motion, &v1::Motion::Stub::SetOverrides, request,
                                    impl_->options.call_timeout);
  if (!response) return std::unexpected(response.error());
  return Overrides{response->feed(), response->rapid(), response->speed()};
}

Result<void> Client::set_work_zero(const std::vector<WorkCoordinate>& coordinates) const {
  v1::SetWorkZeroRequest request;
  for (const WorkCoordinate& coordinate : coordinates) {
    v1::WorkCoordinate& wire = *request.add_coordinates();
    wire.set_axis(to_wire(coordinate.axis));
    wire.set_value(coordinate.value);
  }
  return done(impl_->call(*impl_->motion, &v1::Motion::Stub::SetWorkZero, request,
                          impl_->options.call_timeout));
}

Result<void> Client::accept_position(const std::vector<Axis>& axes) const {
  v1::AcceptPositionRequest request;
  for (const Axis axis : axes) request.add_axes(to_wire(axis));
  return done(impl_->call(*impl_->motion, &v1::Motion::Stub::AcceptPosition, request,
                          impl_->options.call_timeout));
}

Result<void> Client::simulate_estop(bool pressed) const {
  v1::SimulateEstopRequest request;
  request.set_pressed(pressed);
  return done(impl_->call(*impl_->motion, &v1::Motion::Stub::SimulateEstop, request,
                          impl_->options.call_timeout));
}

JogSession Client::jog(const JogOptions& options) const {
  return JogSession(std::make_unique<JogSession::Impl>(impl_, options));
}

Result<void> Client::jog_step(Axis axis, double distance, double rate) const {
  v1::JogStepRequest request;
  request.set_axis(to_wire(axis));
  request.set_distance(distance);
  request.set_rate(rate);
  return done(impl_->call(*impl_->jog, &v1::Jog::Stub::Step, request, impl_->options.call_timeout));
}

Result<void> Client::jog_stop() const {
  return done(impl_->call(*impl_->jog, &v1::Jog::Stub::Stop, v1::JogStopRequest(),
                          impl_->options.call_timeout));
}

Result<LoadedJob> Client::load(std::string_view path) const {
  v1::LoadRequest request;
  request.set_path(std::string(path));
  const auto response =
      impl_->call(*impl_->job, &v1::Job::Stub::Load, request, impl_->options.call_timeout);
  if (!response) return std::unexpected(response.error());
  return LoadedJob{response->path(), response->lines(), response->bytes()};
}

Result<void> Client::run() const {
  return done(
      impl_->call(*impl_->job, &v1::Job::Stub::Run, v1::RunRequest(), impl_->options.call_timeout));
}

Result<void> Client::pause() const {
  return done(impl_->call(*impl_->job, &v1::Job::Stub::Pause, v1::PauseRequest(),
                          impl_->options.call_timeout));
}

Result<void> Client::resume() const {
  return done(impl_->call(*impl_->job, &v1::Job::Stub::Resume, v1::ResumeRequest(),
                          impl_->options.call_timeout));
}

Result<void> Client::stop() const {
  return done(impl_->call(*impl_->job, &v1::Job::Stub::Stop, v1::StopRequest(),
                          impl_->options.call_timeout));
}

Result<void> Client::rewind() const {
  return done(impl_->call(*impl_->job, &v1::Job::Stub::Rewind, v1::RewindRequest(),
                          impl_->options.call_timeout));
}

Result<void> Client::answer(std::uint64_t number, bool confirmed,
                            const std::vector<double>& values) const {
  v1::AnswerRequest request;
  request.set_number(number);
  request.set_confirmed(confirmed);
  request.mutable_values()->Assign(values.begin(), values.end());
  return done(
      impl_->call(*impl_->job, &v1::Job::Stub::Answer, request, impl_->options.call_timeout));
}

Result<ProgramText> Client::read_lines(std::uint64_t first, std::uint32_t count) const {
  v1::ReadLinesRequest request;
  request.set_first(first);
  request.set_count(count);
  const auto response =
      impl_->call(*impl_->job, &v1::Job::Stub::ReadLines, request, impl_->options.call_timeout);
  if (!response) return std::unexpected(response.error());
  return ProgramText{response->first(), {response->lines().begin(), response->lines().end()}};
}

Result<ProblemList> Client::problems() const {
  return converted(impl_->call(*impl_->job, &v1::Job::Stub::GetProblems, v1::GetProblemsRequest(),
                               impl_->options.call_timeout));
}

Result<std::vector<Message>> Client::messages(std::uint64_t after, std::uint32_t limit) const {
  v1::ListMessagesRequest request;
  request.set_after(after);
  request.set_limit(limit);
  const auto response = impl_->call(*impl_->messages, &v1::Messages::Stub::List, request,
                                    impl_->options.call_timeout);
  if (!response) return std::unexpected(response.error());
  std::vector<Message> messages;
  for (const v1::Message& wire : response->messages()) messages.push_back(from_wire(wire));
  return messages;
}

Subscription Client::subscribe_messages(std::uint64_t after, OnMessage on_message,
                                        OnConnectionChange on_connection_change) const {
  return make_message_subscription(impl_, after, std::move(on_message),
                                   std::move(on_connection_change));
}

}  // namespace cnc::api
