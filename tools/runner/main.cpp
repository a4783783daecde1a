// SPDX-License-Identifier: GPL-3.0-or-later
// meshlab-script: MeshLab's filters from the command line, as meshlabserver ran
// them until 2020, for all hosts and without a display.
#include <unistd.h>
#include <wrap/io_trimesh/io_mask.h>

#include <QApplication>
#include <QDomDocument>
#include <QFile>
#include <QFileInfo>
#include <algorithm>
#include <clocale>
#include <cstdio>
#include <map>
#include <stdexcept>

#include "runner_host.h"

namespace {

namespace api = parts::host::api;

const char* const usage =
    "meshlab-script [-p PROJECT.mlp] [-i MESH]... [-s SCRIPT.mlx]... [-w PROJECT.mlp] [-o MESH [-l LAYER] [-m "
    "WORD...]]...\n"
    "The options are carried out in their order. -l counts layers from 0; without it the current one is saved.\n"
    "-m says what is saved besides the surface: vc vf vq vn vt fc ff fq fn wc wn wt. Values that a script leaves\n"
    "out are the filter's defaults. The exit status is 0, or 255 where something failed.\n";

[[noreturn]] void fail(const QString& sentence) { throw std::runtime_error(sentence.toStdString()); }

/// One line that changes on a terminal, nothing elsewhere.
bool show_progress(const int percent, const char* stage) {
  if (isatty(STDERR_FILENO)) std::fprintf(stderr, "\r\33[K%3d %% %s", percent, QByteArray(stage).trimmed().constData());
  return true;
}
void end_progress() {
  if (isatty(STDERR_FILENO)) std::fprintf(stderr, "\r\33[K");
}

/// Prints what the log has that was not printed yet.
class LogPrinter {
 public:
  void print(const MeshDocument& document) {
    const auto lines = document.Log.logStringList();
    for (; printed_ < lines.size(); ++printed_) std::printf("%s\n", lines[printed_].second.toUtf8().constData());
    std::fflush(stdout);
  }

 private:
  int printed_ = 0;
};

class Session {
 public:
  void run(QStringList words);

 private:
  void run_script(const QString& file);
  void run_filter(const QString& name, const RichParameterList& given);
  RichParameterList values_of(const runner::Action& filter, const RichParameterList& given);
  void set_current_layer(const RichParameterList& given);
  void save(QStringList& words);

  MeshDocument document_;
  LogPrinter log_;
};

QString next(QStringList& words) {
  if (words.isEmpty()) fail(usage);
  return words.takeFirst();
}

QString next_file(QStringList& words) { return QFileInfo(next(words)).absoluteFilePath(); }

/// The values of a script over the filter's defaults in this document.
RichParameterList Session::values_of(const runner::Action& filter, const RichParameterList& given) {
  RichParameterList list = runner::defaults_of(filter, document_);
  for (const RichParameter& p : given) {
    if (!list.hasParameter(p.name())) {
      std::printf("warning: The filter has no parameter %s, which is left out.\n", qUtf8Printable(p.name()));
      continue;
    }
    if (!runner::set_value(p, document_, list))
      fail("The script gives " + p.name() + " as a " + p.stringType() + "; it is a " +
           list.getParameterByName(p.name()).stringType() + ".");
  }
  return list;
}

/// A filter until 2020.
void Session::set_current_layer(const RichParameterList& given) {
  int id = -1;
  if (given.hasParameter("layer")) id = api::as_integer(given.getParameterByName("layer").value()).value_or(-1);
  for (MeshModel* layer : api::layers_of(document_))
    if (layer->id() == id) return document_.setCurrentMesh(id);
  fail("There is no such layer to become the current one.");
}

void Session::run_filter(const QString& name, const RichParameterList& given) {
  const runner::Action filter = runner::find_filter(name);
  if (!filter.plugin && name == "Change the current layer") return set_current_layer(given);
  if (!filter.plugin)
    fail("No filter is called \"" + name + "\"; look for its name in MeshLab's menus." + runner::not_loaded());
  const QString missing = runner::missing_for(filter, document_);
  if (!missing.isEmpty()) fail("The filter needs " + missing + ".");
  const RichParameterList values = values_of(filter, given);
  runner::apply(filter, values, document_, show_progress);
  for (MeshModel* layer : api::layers_of(document_)) {  // as the program meshlab leaves them to the next filter
    CMeshO& m = layer->cm;
    vcg::tri::Allocator<CMeshO>::CompactEveryVector(m);
    m.svn = int(vcg::tri::UpdateSelection<CMeshO>::VertexCount(m));
    m.sfn = int(vcg::tri::UpdateSelection<CMeshO>::FaceCount(m));
  }
}

/// The host's reader of scripts leaves out a parameter that lacks an attribute, as
/// a RichEnum does without its choices, and says nothing.
void refuse_lost_parameters(const QString& file, const FilterScript& script) {
  QFile text(file);
  QDomDocument document;
  if (!text.open(QIODevice::ReadOnly) || !document.setContent(&text)) return;
  const QDomNodeList filters = document.documentElement().elementsByTagName("filter");
  for (int i = 0; i < std::min(filters.size(), script.size()); ++i) {
    const QDomNodeList given = filters.at(i).toElement().elementsByTagName("Param");
    for (int k = 0; k < given.size(); ++k)
      if (const QString name = given.at(k).toElement().attribute("name"); !script[i].second.hasParameter(name))
        fail("MeshLab cannot read the parameter " + name + " of \"" + script[i].first +
             "\" in the script; take its line from a script that MeshLab has written.");
  }
}

void Session::run_script(const QString& file) {
  FilterScript script;
  if (!script.open(file)) fail("The script " + file + " cannot be read; it is no MeshLab script (.mlx).");
  refuse_lost_parameters(file, script);
  for (const FilterNameParameterValuesPair& step : script) {
    std::printf("filter: %s\n", qUtf8Printable(step.first));
    try {
      run_filter(step.first, step.second);
      end_progress();
      log_.print(document_);
    } catch (const std::exception& failure) {
      end_progress();
      log_.print(document_);
      std::printf("%s\nProblem with filter: %s\n", failure.what(), qUtf8Printable(step.first));
      throw;
    }
  }
}

int mask_bit(const QString& word) {
  using Mask = vcg::tri::io::Mask;
  static const std::map<QString, int> bits = {
      {"vc", Mask::IOM_VERTCOLOR},  {"vf", Mask::IOM_VERTFLAGS},    {"vq", Mask::IOM_VERTQUALITY},
      {"vn", Mask::IOM_VERTNORMAL}, {"vt", Mask::IOM_VERTTEXCOORD}, {"fc", Mask::IOM_FACECOLOR},
      {"ff", Mask::IOM_FACEFLAGS},  {"fq", Mask::IOM_FACEQUALITY},  {"fn", Mask::IOM_FACENORMAL},
      {"wc", Mask::IOM_WEDGCOLOR},  {"wn", Mask::IOM_WEDGNORMAL},   {"wt", Mask::IOM_WEDGTEXCOORD}};
  const auto bit = bits.find(word);
  if (bit == bits.end()) fail("-m has no " + word + ".\n" + usage);
  return bit->second;
}

void Session::save(QStringList& words) {
  const QString file = next_file(words);
  MeshModel* layer = document_.mm();
  int mask = 0;
  while (!words.isEmpty() && (words.first() == "-l" || words.first() == "-m")) {
    if (words.takeFirst() == "-l") {
      const std::vector<MeshModel*> layers = api::layers_of(document_);
      bool is_number = false;
      const int index = next(words).toInt(&is_number);
      layer = is_number && index >= 0 && index < int(layers.size()) ? layers[index] : nullptr;
    } else {
      while (!words.isEmpty() && !words.first().startsWith('-')) mask |= mask_bit(words.takeFirst());
    }
  }
  if (!layer) fail("There is no layer to save as " + file + ".");
  runner::save_mesh(file, mask, *layer, document_);
  std::printf("Mesh %s saved\n", qUtf8Printable(file));
}

void Session::run(QStringList words) {
  if (words.isEmpty()) fail(usage);
  while (!words.isEmpty()) {
    const QString option = words.takeFirst();
    if (option == "-i") {
      const QString file = next_file(words);
      runner::open_mesh(file, document_);
      std::printf("Mesh %s loaded\n", qUtf8Printable(file));
    } else if (option == "-p") {
      runner::open_project(next_file(words), document_);
    } else if (option == "-s") {
      run_script(next_file(words));
    } else if (option == "-w") {
      runner::save_project(next_file(words), document_);
    } else if (option == "-o") {
      save(words);
    } else {
      fail(usage);
    }
  }
}

/// The host tells its whole log to Qt's too.
void leave_out_debug(QtMsgType type, const QMessageLogContext&, const QString& line) {
  if (type != QtDebugMsg) std::fprintf(stderr, "%s\n", qUtf8Printable(line));
}

}  // namespace

int main(int argc, char** argv) {
  if (qEnvironmentVariableIsEmpty("QT_QPA_PLATFORM")) qputenv("QT_QPA_PLATFORM", "offscreen");
  qInstallMessageHandler(leave_out_debug);
  QApplication application(argc, argv);
  std::setlocale(LC_NUMERIC, "C");
  const QStringList words = application.arguments().mid(1);
  if (words.contains("-h") || words.contains("--help")) {
    std::printf("%s", usage);
    return 0;
  }
  try {
    runner::load_plugins();
    Session().run(words);
    return 0;
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "%s\n", failure.what());
  }
  return 255;
}
