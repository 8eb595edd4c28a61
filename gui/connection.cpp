#include "gui/connection.h"

#include <utility>

#include "gui/jog_lease.h"
#include "gui/text.h"

namespace cnc::gui {
namespace {

constexpr double kStatusesPerSecond = 30.0;

std::optional<api::Error> error_of(const auto& result) {
  if (result) return std::nullopt;
  return result.error();
}

template <typename... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};

}  // namespace

Connection::Connection(const std::string& address, QObject* parent)
    : QObject(parent), client_(api::Client::without_connecting(address)) {
  for (QThreadPool& lane : lanes_) lane.setMaxThreadCount(1);
}

// A homing, a single line or a user key ends with the screen that asked for it; the machine stops.
// A job goes on: it belongs to the server.
Connection::~Connection() {
  jog_session_.reset();
  status_subscription_ = {};
  message_subscription_ = {};
  closing_.request_stop();
  for (QThreadPool& lane : lanes_) lane.clear();
  for (QThreadPool& lane : lanes_) lane.waitForDone();
}

void Connection::start() {
  status_subscription_ = client_.subscribe_status(
      {.max_rate = kStatusesPerSecond},
      [this](const api::MachineStatus& status) { on_status(status); },
      [this](const api::ConnectionChange& change) { on_connection_change(change); });
  message_subscription_ = client_.subscribe_messages(0, [this](const api::Message& message) {
    post([this, message] { emit message_arrived(message); });
  });
}

QString Connection::address() const { return to_text(client_.address()); }

template <typename Signal>
void Connection::post(Signal signal) {
  QMetaObject::invokeMethod(this, std::move(signal), Qt::QueuedConnection);
}

void Connection::on_connection_change(const api::ConnectionChange& change) {
  is_introduced_ = false;
  if (change.connected) return;  // announced with the first status
  const QString reason = change.reason ? to_text(change.reason->to_string()) : QString();
  post([this, reason] {
    end_jog();
    emit disconnected(reason);
  });
}

void Connection::on_status(const api::MachineStatus& status) {
  if (!is_introduced_) is_introduced_ = introduce();
  if (!is_introduced_) return;
  const std::lock_guard lock(newest_mutex_);
  const bool is_posted = std::exchange(newest_status_, status).has_value();
  if (!is_posted) post([this] { deliver_newest_status(); });
}

bool Connection::introduce() {
  const auto machine = client_.machine();
  const auto version = client_.version();
  if (!machine || !version) return false;  // tried again with the next status
  post([this, facts = MachineFacts{*machine, *version}] { emit connected(facts); });
  return true;
}

void Connection::deliver_newest_status() {
  std::optional<api::MachineStatus> status;
  {
    const std::lock_guard lock(newest_mutex_);
    status.swap(newest_status_);
  }
  if (status) emit status_arrived(*status);
}

void Connection::execute(const Request& request) {
  QThreadPool& lane = lanes_.at(request.index());
  const auto task = [this, request] {
    if (auto error = carry_out(request)) {
      post([this, request, error = *std::move(error)] { emit refused(request, error); });
    }
  };
  // A second tap on a user key, before the key is grey, is no wish for a second run.
  if (!std::holds_alternative<RunSub>(request)) return lane.start(task);
  static_cast<void>(lane.tryStart(task));
}

std::optional<api::Error> Connection::carry_out(const Request& request) {
  const auto load = [this](const Load& wanted) {
    const auto job = client_.load(wanted.path);
    if (job) post([this, job = *job] { emit loaded(job); });
    return error_of(job);
  };
  return std::visit(
      Overloaded{
          [&](const Reset&) { return error_of(client_.reset()); },
          [&](const Home& home) { return error_of(client_.home(home.axes, closing_.get_token())); },
          [&](const AcceptPosition& accept) {
            return error_of(client_.accept_position(accept.axes));
          },
          [&](const Mdi& mdi) { return error_of(client_.mdi(mdi.line, closing_.get_token())); },
          load,
          [&](const Run&) { return error_of(client_.run()); },
          [&](const Pause&) { return error_of(client_.pause()); },
          [&](const Resume&) { return error_of(client_.resume()); },
          [&](const Stop&) { return error_of(client_.stop()); },
          [&](const Rewind&) { return error_of(client_.rewind()); },
          [&](const SetOverrides& set) { return error_of(client_.set_overrides(set.change)); },
          [&](const SetWorkZero& set) { return error_of(client_.set_work_zero(set.coordinates)); },
          [&](const JogStep& step) { return error_of(client_.jog_step(step.axis, step.distance)); },
          [&](const RunSub& sub) {
            return error_of(client_.run_sub(sub.name, closing_.get_token()));
          },
          [&](const Answer& answer) {
            return error_of(client_.answer(answer.question, answer.confirmed, answer.values));
          },
      },
      request);
}

void Connection::fetch_page(const PageRequest& request) {
  lanes_[kFetchLane].start([this, request] {
    const auto text = client_.read_lines(request.first, request.count);
    if (!text) return post([this, request] { emit page_failed(request); });
    post([this, request, text = *text] { emit page_arrived(request, text); });
  });
}

void Connection::fetch_problems() {
  lanes_[kFetchLane].start([this] {
    const auto problems = client_.problems();
    if (problems) post([this, problems = *problems] { emit problems_arrived(problems); });
  });
}

void Connection::jog(const api::JogVelocities& velocities) {
  if (!jog_session_) jog_session_ = client_.jog({.lease = JogLease::kLease});
  const auto accepted = jog_session_->set(velocities);
  if (accepted) return;
  jog_session_.reset();
  emit jog_refused(accepted.error());
}

void Connection::end_jog() { jog_session_.reset(); }

}  // namespace cnc::gui
