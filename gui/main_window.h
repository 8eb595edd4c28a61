// The operator's screen: puts the panels together and passes on what they say. No panel knows
// another one, and none knows the network: commands leave as requests, the state comes in by the
// slots.
#pragma once

#include <QWidget>

#include "api/jog.h"
#include "api/message.h"
#include "gui/command_bar.h"
#include "gui/dro_panel.h"
#include "gui/job_panel.h"
#include "gui/jog_keys.h"
#include "gui/jog_lease.h"
#include "gui/jog_panel.h"
#include "gui/machine_facts.h"
#include "gui/machine_keys.h"
#include "gui/mdi_line.h"
#include "gui/message_bar.h"
#include "gui/override_panel.h"
#include "gui/program_panel.h"
#include "gui/question_dialog.h"
#include "gui/request.h"
#include "gui/state_bar.h"
#include "gui/user_keys.h"

namespace cnc::gui {

class MainWindow : public QWidget {
  Q_OBJECT

 public:
  /// `address`: the server's, as the operator shall read it. Without `files_are_local`, a path is
  /// asked for as text, because the files lie on another computer.
  MainWindow(QString address, bool files_are_local, QWidget* parent = nullptr);

  /// Loads this file as soon as the machine allows it.
  void load_when_ready(const std::string& path) { file_to_load_ = path; }

  // From the connection.
  void show_connected(const cnc::gui::MachineFacts& facts);
  void show_disconnected(const QString& reason);
  void show_status(const cnc::api::MachineStatus& status);
  void show_message(const cnc::api::Message& message) { messages_->add(message); }
  void show_refusal(const cnc::gui::Request& request, const cnc::api::Error& error);
  void show_jog_refusal(const cnc::api::Error& error);

  [[nodiscard]] ProgramPanel& program() { return *program_; }
  [[nodiscard]] JogLease& jog_lease() { return jog_lease_; }

 signals:
  void requested(const cnc::gui::Request& request);

 private:
  void lay_out();
  void connect_panels();
  void ask_for_file();
  [[nodiscard]] QRect place_of_question() const;
  void load_waiting_file(const api::MachineStatus& status);

  QString address_;
  bool files_are_local_;
  std::string file_to_load_;

  JogLease jog_lease_;
  JogKeys jog_keys_;
  MachineKeys machine_keys_;
  StateBar* state_bar_;
  MessageBar* messages_;
  QWidget* page_;  // everything that is grey without a machine
  ProgramPanel* program_;
  MdiLine* mdi_;
  JogPanel* jog_;
  DroPanel* dro_;
  OverridePanel* overrides_;
  JobPanel* job_;
  UserKeys* user_keys_;
  CommandBar* commands_;
  QuestionDialog* question_;  // over everything
};

}  // namespace cnc::gui
