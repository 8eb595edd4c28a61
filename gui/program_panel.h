// The program: its name, its lines, what the check found, and how far the job is.
#pragma once

#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QWidget>

#include "api/status.h"
#include "gui/program_model.h"
#include "gui/program_view.h"

namespace cnc::gui {

class ProgramPanel : public QWidget {
  Q_OBJECT

 public:
  explicit ProgramPanel(QWidget* parent = nullptr);

  void show_status(const api::MachineStatus& status);
  void show_problems(const api::ProblemList& problems);
  /// This screen has loaded a file, perhaps the same path anew: its text is fetched again.
  void show_loaded(const api::LoadedJob& job);
  /// What was fetched from a server that is gone may be another server's next time.
  void forget();
  [[nodiscard]] ProgramModel& model() { return model_; }

 signals:
  void problems_wanted();

 private:
  void show_job(const std::string& path, quint64 lines);
  void show_progress(const api::JobStatus& job);

  ProgramModel model_;
  ProgramView* view_;
  QLabel* title_;
  QPushButton* problems_;
  QProgressBar* progress_;
  QLabel* times_;
  std::string path_;
  quint64 lines_ = 0;
  quint64 known_problems_ = 0;
  int problem_row_ = -1;
};

}  // namespace cnc::gui
