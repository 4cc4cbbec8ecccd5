// Inverse dynamics of GRiD on the samples of a file:  program N IN OUT, compiled with -DREAL=float or double
// (both in one program declare GRiD's shared memory twice).
// Prints the number of threads a sample that was fastest, and seconds of a launch (the median of many, by events).
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "grid.cuh"

using T = REAL;

int run(int n, const char *source, const char *target) {
    const int nq = grid::NUM_JOINTS;
    std::vector<T> in(size_t(3) * nq * n), q_qd_u(size_t(3) * nq * n, T(0)), qdd(size_t(nq) * n), out(size_t(nq) * n);
    FILE *f = fopen(source, "rb");
    if (!f || fread(in.data(), sizeof(T), in.size(), f) != in.size()) return 2;
    fclose(f);
    for (size_t k = 0; k < size_t(n); k++) {
        std::copy_n(&in[3 * nq * k], 2 * nq, &q_qd_u[3 * nq * k]);
        std::copy_n(&in[3 * nq * k + 2 * nq], nq, &qdd[nq * k]);
    }
    T *d_q, *d_qdd, *d_c;
    gpuErrchk(cudaMalloc(&d_q, q_qd_u.size() * sizeof(T)));
    gpuErrchk(cudaMalloc(&d_qdd, qdd.size() * sizeof(T)));
    gpuErrchk(cudaMalloc(&d_c, out.size() * sizeof(T)));
    gpuErrchk(cudaMemcpy(d_q, q_qd_u.data(), q_qd_u.size() * sizeof(T), cudaMemcpyHostToDevice));
    gpuErrchk(cudaMemcpy(d_qdd, qdd.data(), qdd.size() * sizeof(T), cudaMemcpyHostToDevice));
    grid::robotModel<T> *model = grid::init_robotModel<T>();
    cudaEvent_t begin, end;
    cudaEventCreate(&begin);
    cudaEventCreate(&end);
    float best = 1e30f;
    int fastest = 0;
    for (int threads : {32, 64, 96, 128, 192, 352}) {
        std::vector<float> times;
        for (int repetition = 0; repetition < 25; repetition++) {
            cudaEventRecord(begin);
            grid::inverse_dynamics_kernel<T><<<n, threads, grid::ID_DYNAMIC_SHARED_MEM_COUNT * sizeof(T)>>>(
                d_c, d_q, 3 * nq, d_qdd, model, T(9.81), n);
            cudaEventRecord(end);
            gpuErrchk(cudaEventSynchronize(end));
            float ms;
            cudaEventElapsedTime(&ms, begin, end);
            times.push_back(ms);
        }
        gpuErrchk(cudaGetLastError());
        std::nth_element(times.begin(), times.begin() + 12, times.end());
        if (times[12] < best) best = times[12], fastest = threads;
    }
    gpuErrchk(cudaMemcpy(out.data(), d_c, out.size() * sizeof(T), cudaMemcpyDeviceToHost));
    f = fopen(target, "wb");
    fwrite(out.data(), sizeof(T), out.size(), f);
    fclose(f);
    printf("%d %.9g\n", fastest, best * 1e-3);
    return 0;
}

int main(int argc, char **argv) { return argc == 4 ? run(atoi(argv[1]), argv[2], argv[3]) : 2; }
