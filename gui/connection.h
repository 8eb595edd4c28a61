// The screen's side of libcncapi: what comes from the server becomes Qt signals in the thread of
// this object, what the screen wants is carried out on threads behind it. No call here waits.
//
// The one exception is jog(): it runs in the caller's thread, because a lease that another thread
// renews would outlive a screen that hangs. It does not wait either.
#pragma once

#include <QObject>
#include <QThreadPool>
#include <array>
#include <mutex>
#include <optional>
#include <stop_token>

#include "api/client.h"
#include "gui/machine_facts.h"
#include "gui/program_model.h"
#include "gui/request.h"

namespace cnc::gui {

class Connection : public QObject {
  Q_OBJECT

 public:
  /// Tries for as long as it lives; begins when start() is called.
  explicit Connection(const std::string& address, QObject* parent = nullptr);
  ~Connection() override;

  void start();

  [[nodiscard]] QString address() const;
  /// Paths mean the same here and on the server.
  [[nodiscard]] bool is_local() const { return client_.is_local(); }

  /// Requests of one kind are carried out in their order; no kind waits for another, so that a stop
  /// overtakes a homing. A user key is left out while another one is under way.
  void execute(const cnc::gui::Request& request);
  void fetch_page(const cnc::gui::PageRequest& request);
  void fetch_problems();

  void jog(const cnc::api::JogVelocities& velocities);
  void end_jog();

 signals:
  void connected(const cnc::gui::MachineFacts& facts);
  void disconnected(const QString& reason);
  /// The newest one: those that the screen was too slow for are left out.
  void status_arrived(const cnc::api::MachineStatus& status);
  void message_arrived(const cnc::api::Message& message);
  void refused(const cnc::gui::Request& request, const cnc::api::Error& error);
  void jog_refused(const cnc::api::Error& error);
  void loaded(const cnc::api::LoadedJob& job);
  void page_arrived(const cnc::gui::PageRequest& request, const cnc::api::ProgramText& text);
  void page_failed(const cnc::gui::PageRequest& request);
  void problems_arrived(const cnc::api::ProblemList& problems);

 private:
  static constexpr std::size_t kLaneCount = std::variant_size_v<Request> + 1;
  static constexpr std::size_t kFetchLane = kLaneCount - 1;

  // On the status subscription's thread.
  void on_connection_change(const api::ConnectionChange& change);
  void on_status(const api::MachineStatus& status);
  [[nodiscard]] bool introduce();

  void deliver_newest_status();
  [[nodiscard]] std::optional<api::Error> carry_out(const Request& request);
  template <typename Signal>
  void post(Signal signal);

  api::Client client_;
  std::stop_source closing_;
  std::array<QThreadPool, kLaneCount> lanes_;
  bool is_introduced_ = false;  // subscription's thread only

  std::mutex newest_mutex_;
  std::optional<api::MachineStatus> newest_status_;

  std::optional<api::JogSession> jog_session_;
  api::Subscription status_subscription_;
  api::Subscription message_subscription_;
};

}  // namespace cnc::gui
