// The lines of the loaded program, fetched in pages when they are looked at: a file of a hundred
// million lines costs as much memory as a short one.
#pragma once

#include <QAbstractListModel>
#include <QSet>
#include <QStringList>
#include <list>
#include <map>
#include <unordered_map>

#include "api/job.h"

namespace cnc::gui {

/// A page that is missing. `job` counts the programs that were shown, so that a late answer for the
/// program before is not taken for this one's.
struct PageRequest {
  quint64 job = 0;
  quint64 first = 1;  ///< line, from 1
  quint32 count = 0;
};

class ProgramModel : public QAbstractListModel {
  Q_OBJECT

 public:
  static constexpr quint64 kPageLines = 256;
  static constexpr std::size_t kMostPages = 64;

  enum Role : int {
    kIsCurrent = Qt::UserRole,  ///< bool: the line in execution
    kProblem,                   ///< QString: what is wrong with the line; empty if nothing
    kIsWarning,                 ///< bool: the problem does not stop the job
  };

  using QAbstractListModel::QAbstractListModel;

  /// Another program, or none with zero lines; forgets everything about the one before.
  void set_program(quint64 lines);
  /// From 1; 0 = none.
  void set_current_line(quint64 line);
  void set_problems(const std::vector<api::Problem>& problems);

  /// Says which rows are looked at; asks for those that are missing.
  void look_at(int first_row, int last_row);
  void take_page(const cnc::gui::PageRequest& request, const api::ProgramText& text);
  /// The page may be asked for again.
  void drop_page(const cnc::gui::PageRequest& request);

  [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;

  [[nodiscard]] int current_row() const { return static_cast<int>(current_line_) - 1; }
  /// The first row after `row` with a problem, or the first of all; -1 = there is none.
  [[nodiscard]] int next_problem_row(int row) const;
  [[nodiscard]] std::size_t cached_pages() const { return pages_.size(); }

 signals:
  void page_wanted(const cnc::gui::PageRequest& request);

 private:
  struct Page {
    QStringList lines;
    std::list<quint64>::iterator age;
  };
  struct LineProblem {
    QString text;
    bool warning;
  };

  void look_at_page(quint64 page);
  void forget_oldest_page();
  [[nodiscard]] QString line_text(quint64 row) const;
  void row_changed(int row, const QList<int>& roles);

  quint64 job_ = 0;
  quint64 lines_ = 0;
  quint64 current_line_ = 0;
  std::unordered_map<quint64, Page> pages_;
  std::list<quint64> ages_;  // page numbers, the one looked at last in front
  QSet<quint64> wanted_;
  std::map<int, LineProblem> problems_;  // by row
};

}  // namespace cnc::gui

Q_DECLARE_METATYPE(cnc::gui::PageRequest)
