#include "gui/job_panel.h"

#include <QHBoxLayout>

#include "gui/state_look.h"
#include "gui/style.h"

namespace cnc::gui {
namespace {

constexpr int kHeight = 68;

QString resume_text(const api::MachineStatus& status) {
  if (status.state == api::MachineState::tool_change) {
    return JobPanel::tr("Continue\nwith T%1").arg(status.selected_tool);
  }
  if (status.state == api::MachineState::program_stop) return JobPanel::tr("Continue");
  return JobPanel::tr("Resume");
}

}  // namespace

RunKey run_key(const api::MachineStatus& status) {
  const api::CommandAvailability& resume = status.availability(api::Command::resume);
  if (resume.allowed) return {resume_text(status), Resume{}, resume};
  return {JobPanel::tr("Run"), Run{}, status.availability(api::Command::run)};
}

JobPanel::JobPanel(QWidget* parent)
    : QWidget(parent),
      run_(new CommandButton(tr("Run"), this)),
      pause_(new CommandButton(tr("Esc\nPause"), this)),
      stop_(new CommandButton(tr("■\nStop"), this)) {
  auto* const row = new QHBoxLayout(this);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(8);
  row->addWidget(run_, 3);
  row->addWidget(pause_, 2);
  row->addSpacing(12);  // what cannot be undone stands apart
  row->addWidget(stop_, 2);
  for (CommandButton* const button : {run_, pause_, stop_}) button->setFixedHeight(kHeight);
  run_->setObjectName(QStringLiteral("run"));
  pause_->setObjectName(QStringLiteral("pause"));
  stop_->setObjectName(QStringLiteral("stop"));
  connect(run_, &QPushButton::clicked, this, [this] { emit requested(run_request_); });
  connect(pause_, &QPushButton::clicked, this, [this] { emit requested(Pause{}); });
  connect(stop_, &QPushButton::clicked, this, [this] { emit requested(Stop{}); });
}

void JobPanel::show_status(const api::MachineStatus& status) {
  const RunKey key = run_key(status);
  run_request_ = key.request;
  set_text(*run_, key.text);
  run_->show_availability(key.availability);
  run_->set_awaited(look_of(status.state).next == api::Command::resume);
  pause_->show_availability(status.availability(api::Command::pause));
  stop_->show_availability(status.availability(api::Command::stop));
}

}  // namespace cnc::gui
