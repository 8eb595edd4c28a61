// Colours and the style sheet: a calm grey ground, saturated colour only where it means something.
//
// Meanings follow IEC 60073: red fault, yellow abnormal or waiting, green normal, blue "the
// operator acts now". Colour never stands alone: a shape and a word go with it, for those who
// cannot tell red from green. Red is a ground with white text on it, as red text on a dark ground
// is not readable enough (contrast 3.6).
#pragma once

#include <QApplication>
#include <QColor>
#include <QString>
#include <QWidget>

namespace cnc::gui {

namespace colour {
inline constexpr QRgb kGround = 0xff16191d;
inline constexpr QRgb kPanel = 0xff1e2329;
inline constexpr QRgb kKey = 0xff2c333b;
inline constexpr QRgb kKeyPressed = 0xff465160;
inline constexpr QRgb kEdge = 0xff3a434d;
inline constexpr QRgb kText = 0xfff2f4f6;
inline constexpr QRgb kDimText = 0xffa9b1ba;
inline constexpr QRgb kOffText = 0xff69727c;
inline constexpr QRgb kGrey = 0xff8a9099;
inline constexpr QRgb kYellow = 0xfff5c518;
inline constexpr QRgb kGreen = 0xff1fa971;
inline constexpr QRgb kRed = 0xffd7263d;
inline constexpr QRgb kBlue = 0xff2f7de1;
}  // namespace colour

/// Gives the application its palette and style.qss.
void set_up_look(QApplication& application);

/// Sets the dynamic property `name`, by which style.qss tells states apart, and applies the style
/// again if it changed.
void set_look(QWidget& widget, const char* name, const QString& value);

/// Sets the text of a label or button only if it differs: a status comes many times a second.
template <typename Widget>
void set_text(Widget& widget, const QString& text) {
  if (widget.text() != text) widget.setText(text);
}

}  // namespace cnc::gui
