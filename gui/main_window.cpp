#include "gui/main_window.h"

#include <QFileDialog>
#include <QGridLayout>
#include <QInputDialog>
#include <QVBoxLayout>
#include <utility>

#include "gui/text.h"

namespace cnc::gui {
namespace {

constexpr int kMargin = 8;
constexpr int kRightWidth = 456;

std::vector<api::Axis> axes_of(const api::Machine& machine) {
  std::vector<api::Axis> axes;
  for (const api::AxisDescription& description : machine.axes) axes.push_back(description.axis);
  return axes;
}

}  // namespace

MainWindow::MainWindow(QString address, bool files_are_local, QWidget* parent)
    : QWidget(parent),
      address_(std::move(address)),
      files_are_local_(files_are_local),
      jog_keys_(*this, jog_lease_),
      state_bar_(new StateBar(this)),
      messages_(new MessageBar(this)),
      page_(new QWidget(this)),
      program_(new ProgramPanel(page_)),
      mdi_(new MdiLine(page_)),
      jog_(new JogPanel(jog_lease_, page_)),
      dro_(new DroPanel(page_)),
      overrides_(new OverridePanel(page_)),
      job_(new JobPanel(page_)),
      user_keys_(new UserKeys(page_)),
      commands_(new CommandBar(page_)),
      question_(new QuestionDialog(this)) {
  setWindowTitle(tr("CNC"));
  setFocusPolicy(Qt::ClickFocus);  // a tap beside an editor gives the arrow keys back to jogging
  page_->setObjectName(QStringLiteral("page"));
  lay_out();
  connect_panels();
  const api::Axis kUsual[] = {api::Axis::X, api::Axis::Y, api::Axis::Z};
  dro_->show_axes({std::begin(kUsual), std::end(kUsual)});
  jog_->show_axes({std::begin(kUsual), std::end(kUsual)});
  show_disconnected({});
}

void MainWindow::lay_out() {
  auto* const left = new QVBoxLayout;
  left->setSpacing(kMargin);
  left->addWidget(program_, 1);
  left->addWidget(user_keys_);
  left->addWidget(mdi_);
  left->addWidget(jog_);
  user_keys_->hide();
  auto* const right = new QVBoxLayout;
  right->setSpacing(kMargin);
  right->addWidget(dro_, 1);
  right->addWidget(overrides_);
  right->addWidget(job_);
  dro_->setFixedWidth(kRightWidth);

  auto* const grid = new QGridLayout(page_);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setSpacing(kMargin);
  grid->setHorizontalSpacing(2 * kMargin);
  grid->addLayout(left, 0, 0);
  grid->addLayout(right, 0, 1);
  grid->addWidget(commands_, 1, 0, 1, 2);
  grid->setColumnStretch(0, 1);
  grid->setRowStretch(0, 1);

  auto* const column = new QVBoxLayout(this);
  column->setContentsMargins(kMargin, kMargin, kMargin, kMargin);
  column->setSpacing(kMargin);
  column->addWidget(state_bar_);
  column->addWidget(messages_);
  column->addWidget(page_, 1);
}

void MainWindow::connect_panels() {
  connect(mdi_, &MdiLine::requested, this, &MainWindow::requested);
  connect(jog_, &JogPanel::requested, this, &MainWindow::requested);
  connect(dro_, &DroPanel::requested, this, &MainWindow::requested);
  connect(overrides_, &OverridePanel::requested, this, &MainWindow::requested);
  connect(job_, &JobPanel::requested, this, &MainWindow::requested);
  connect(commands_, &CommandBar::requested, this, &MainWindow::requested);
  connect(commands_, &CommandBar::load_wanted, this, &MainWindow::ask_for_file);
  connect(commands_, &CommandBar::user_keys_wanted, user_keys_, &QWidget::setVisible);
  connect(user_keys_, &UserKeys::requested, this, &MainWindow::requested);
  connect(question_, &QuestionDialog::requested, this, &MainWindow::requested);
  connect(&machine_keys_, &MachineKeys::requested, this, [this](const Request& request) {
    jog_lease_.release_all();
    if (page_->isEnabled()) emit requested(request);
  });
  connect(&jog_keys_, &JogKeys::armed_changed, jog_, &JogPanel::show_keys_armed);
}

void MainWindow::show_connected(const MachineFacts& facts) {
  state_bar_->show_connected(to_text(facts.version.controller));
  const std::vector<api::Axis> axes = axes_of(facts.machine);
  dro_->show_axes(axes);
  jog_->show_axes(axes);
  question_->set_picture_folder(to_text(facts.machine.picture_folder));
  page_->setEnabled(true);
}

void MainWindow::show_disconnected(const QString& reason) {
  jog_lease_.set_allowed(false);
  state_bar_->show_disconnected(address_, reason);
  program_->forget();
  page_->setEnabled(false);
  question_->show_disconnected();
}

void MainWindow::show_status(const api::MachineStatus& status) {
  jog_lease_.set_allowed(status.availability(api::Command::jog).allowed);
  state_bar_->show_status(status);
  program_->show_status(status);
  mdi_->show_status(status);
  jog_->show_status(status);
  dro_->show_status(status);
  overrides_->show_status(status);
  job_->show_status(status);
  user_keys_->show_status(status);
  commands_->show_status(status);
  question_->set_area(place_of_question());
  question_->show_status(status);
  load_waiting_file(status);
}

void MainWindow::load_waiting_file(const api::MachineStatus& status) {
  if (file_to_load_.empty() || !status.availability(api::Command::load).allowed) return;
  emit requested(Load{std::exchange(file_to_load_, {})});
}

/// Over the left column: the read-outs and the keys of the job stay visible.
QRect MainWindow::place_of_question() const {
  const QRect column = program_->geometry().united(mdi_->geometry()).united(jog_->geometry());
  return column.translated(page_->pos());
}

void MainWindow::show_refusal(const Request& request, const api::Error& error) {
  if (std::holds_alternative<Answer>(request)) question_->show_refused();
  // Esc pauses whatever happens; that there was nothing to pause is no news.
  const bool nothing_to_pause =
      std::holds_alternative<Pause>(request) && error.kind == api::ErrorKind::refused;
  if (!nothing_to_pause) messages_->add_error(request_name(request), error);
}

void MainWindow::show_jog_refusal(const api::Error& error) {
  jog_lease_.release_all();
  messages_->add_error(tr("Jog"), error);
}

void MainWindow::ask_for_file() {
  // Neither dialog is waited for: the screen goes on living behind it.
  if (files_are_local_) {
    auto* const dialog = new QFileDialog(this, tr("Load a program"));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setOption(QFileDialog::DontUseNativeDialog);
    dialog->setFileMode(QFileDialog::ExistingFile);
    connect(dialog, &QFileDialog::fileSelected, this,
            [this](const QString& path) { emit requested(Load{path.toStdString()}); });
    dialog->open();
    return;
  }
  auto* const dialog = new QInputDialog(this);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setLabelText(tr("Path of the program on the machine's computer"));
  connect(dialog, &QInputDialog::textValueSelected, this,
          [this](const QString& path) { emit requested(Load{path.toStdString()}); });
  dialog->open();
}

}  // namespace cnc::gui
