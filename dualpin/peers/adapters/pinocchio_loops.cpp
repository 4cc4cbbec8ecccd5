// Pinocchio's algorithms in C++ loops over a batch, from its headers: -O3 -march=native; with -DCODEGEN the code that
// CppADCodeGen generates of them.
#ifdef CODEGEN
#include <pinocchio/codegen/cppadcg-algo.hpp>
#endif
#include <algorithm>
#include <cstring>
#include <memory>
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea-second-order-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody.hpp>
#include <string>

using namespace pinocchio;
using Vector = Eigen::Map<const Eigen::VectorXd>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Rows3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

struct Robot {
  Model model;
  std::unique_ptr<Data> data;
#ifdef CODEGEN
  std::unique_ptr<CodeGenBase<double>> generated;
#endif
};

static JointIndex joint(Model& m, JointIndex parent, int kind, const Eigen::Vector3d& axis, const SE3& at, const std::string& name) {
  const bool x = axis == Eigen::Vector3d::UnitX(), y = axis == Eigen::Vector3d::UnitY(), z = axis == Eigen::Vector3d::UnitZ();
  if (kind == 2) return m.addJoint(parent, JointModelFreeFlyer(), at, name);
  if (kind == 0)
    return x   ? m.addJoint(parent, JointModelRX(), at, name)
           : y ? m.addJoint(parent, JointModelRY(), at, name)
           : z ? m.addJoint(parent, JointModelRZ(), at, name)
               : m.addJoint(parent, JointModelRevoluteUnaligned(axis), at, name);
  return x   ? m.addJoint(parent, JointModelPX(), at, name)
         : y ? m.addJoint(parent, JointModelPY(), at, name)
         : z ? m.addJoint(parent, JointModelPZ(), at, name)
             : m.addJoint(parent, JointModelPrismaticUnaligned(axis), at, name);
}

// Each joint: kind (0 turns, 1 slides, 2 floats), parent (-1: the ground), then 30 numbers: axis, position, rotation by rows,
// mass, centre of mass, inertia about it by rows, armature.
extern "C" void* make(int n, const int* kinds, const int* parents, const double* numbers, const double* gravity) {
  auto* r = new Robot;
  Model& m = r->model;
  for (int i = 0; i < n; i++) {
    const double* d = numbers + 30 * i;
    const SE3 at(Eigen::Map<const Rows3>(d + 6), Eigen::Map<const Eigen::Vector3d>(d + 3));
    const JointIndex id = joint(m, JointIndex(parents[i] + 1), kinds[i], Eigen::Map<const Eigen::Vector3d>(d), at, "j" + std::to_string(i));
    m.appendBodyToJoint(id, Inertia(d[15], Eigen::Map<const Eigen::Vector3d>(d + 16), Eigen::Map<const Rows3>(d + 19)), SE3::Identity());
    if (kinds[i] != 2) m.armature[m.joints[id].idx_v()] = d[28];
  }
  m.gravity.linear() = Eigen::Map<const Eigen::Vector3d>(gravity);
  r->data = std::make_unique<Data>(m);
  return r;
}

template <class F>
static void loop(const Model& m, int n, const double* q, const double* v, const double* a, F f) {
  for (int i = 0; i < n; i++)
    f(i, Vector(q + i * m.nq, m.nq), Vector(v + i * m.nv, m.nv), Vector(a + i * m.nv, m.nv));
}

static void store(double* out, int i, const Eigen::MatrixXd& M, bool symmetric = false) {
  Eigen::Map<Rows> to(out + i * M.size(), M.rows(), M.cols());
  to = M;
  if (symmetric) to.triangularView<Eigen::StrictlyLower>() = to.transpose().triangularView<Eigen::StrictlyLower>();
}

#ifdef CODEGEN
template <class Base>
struct Forward : Base {
  explicit Forward(const Model& m) : Base(m) { this->build_jacobian = false; }
  void evaluate(const double* x) {
    this->generatedFun_ptr->ForwardZero(CppAD::cg::ArrayView<const double>(x, this->ad_X.size()),
                                        CppAD::cg::ArrayView<double>(this->y.data(), this->y.size()));
  }
  const Eigen::VectorXd& result() const { return this->y; }
};

template <class Base>
static int generated(Robot* r, int n, int times, const double* x, double* out, const char* compiler) {
  auto* g = dynamic_cast<Forward<Base>*>(r->generated.get());
  if (!g) {
    g = new Forward<Base>(r->model);
    r->generated.reset(g);
    g->initLib();
    g->compileLib(compiler, "-Ofast");
    g->loadLib(false);
  }
  const int size = r->model.nq + 2 * r->model.nv, width = int(g->result().size());
  for (int t = 0; t < times; t++)
    for (int i = 0; i < n; i++) {
      g->evaluate(x + size_t(i) * size);
      if (out) std::copy_n(g->result().data(), width, out + size_t(i) * width);
    }
  return 0;
}

// x: rows q, v, a
extern "C" int run(void* robot, const char* term, int n, int times, const double* x, double* out, const char* compiler) {
  auto* r = static_cast<Robot*>(robot);
  if (!std::strcmp(term, "rnea")) return generated<CodeGenRNEA<double>>(r, n, times, x, out, compiler);
  if (!std::strcmp(term, "aba")) return generated<CodeGenABA<double>>(r, n, times, x, out, compiler);
  return 1;
}
#else
// Without `out` results stay in Pinocchio's own memory: the loop is timed so.
extern "C" int run(void* robot, const char* term, int n, int times, const double* q, const double* v, const double* a, double* out) {
  auto* r = static_cast<Robot*>(robot);
  const Model& m = r->model;
  Data& d = *r->data;
  const std::string name(term);
  for (int t = 0; t < times; t++) {
    if (name == "rnea")
      loop(m, n, q, v, a, [&](int i, auto q, auto v, auto a) { rnea(m, d, q, v, a); if (out) store(out, i, d.tau); });
    else if (name == "aba")
      loop(m, n, q, v, a, [&](int i, auto q, auto v, auto a) { aba(m, d, q, v, a, Convention::LOCAL); if (out) store(out, i, d.ddq); });
    else if (name == "crba")
      loop(m, n, q, v, a, [&](int i, auto q, auto, auto) { crba(m, d, q, Convention::LOCAL); if (out) store(out, i, d.M, true); });
    else if (name == "coriolis")
      loop(m, n, q, v, a, [&](int i, auto q, auto v, auto) { computeCoriolisMatrix(m, d, q, v); if (out) store(out, i, d.C); });
    else if (name == "minv")
      loop(m, n, q, v, a, [&](int i, auto q, auto, auto) { computeMinverse(m, d, q); if (out) store(out, i, d.Minv, true); });
    else if (name == "fk")
      loop(m, n, q, v, a, [&](int i, auto q, auto, auto) {
        forwardKinematics(m, d, q);
        if (out)
          for (int j = 1; j < m.njoints; j++) store(out, i * (m.njoints - 1) + j - 1, d.oMi[j].toHomogeneousMatrix());
      });
    else if (name == "rnea_derivatives")
      loop(m, n, q, v, a, [&](int i, auto q, auto v, auto a) {
        computeRNEADerivatives(m, d, q, v, a);
        if (out) {
          store(out, 3 * i, d.dtau_dq);
          store(out, 3 * i + 1, d.dtau_dv);
          store(out, 3 * i + 2, d.M, true);
        }
      });
    else if (name == "rnea_second_derivatives")
      loop(m, n, q, v, a, [&](int i, auto q, auto v, auto a) {
        ComputeRNEASecondOrderDerivatives(m, d, q, v, a);
        const int size = m.nv * m.nv * m.nv;
        if (out) {  // column by column
          double* to = out + size_t(4) * i * size;
          std::copy_n(d.d2tau_dqdq.data(), size, to);
          std::copy_n(d.d2tau_dqdv.data(), size, to + size);
          std::copy_n(d.d2tau_dvdv.data(), size, to + 2 * size);
          std::copy_n(d.d2tau_dadq.data(), size, to + 3 * size);
        }
      });
    else
      return 1;
  }
  return 0;
}
#endif
