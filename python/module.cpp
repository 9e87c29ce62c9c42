// module.cpp: tangipaint._tangipaint, which the package tangipaint shows as its own.
#include <glog/logging.h>

#include "python/bindings.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/file/version.h"

namespace py = pybind11;

PYBIND11_MODULE(_tangipaint, module) {
    using namespace tangi;
    FLAGS_minloglevel = google::GLOG_FATAL;  // of Ceres, whose numbers are in our reports
    module.attr("__version__") = version();
    // The kinds of surface/base/error.h; poor numbers are a warning, in __init__.py.
    py::register_exception<Error>(module, "Error", PyExc_RuntimeError);
    py::register_exception<ContractError>(module, "ContractError", PyExc_AssertionError);
    py::register_exception<Cancelled>(module, "Cancelled", PyExc_RuntimeError);
    python::bind_relight(module);
    python::bind_painting(module);
    python::bind_stack(module);
    python::bind_canvas(module);
    module.def("set_threads", &set_thread_count, py::arg("threads"), "threads to use; 0: all cores");
}
