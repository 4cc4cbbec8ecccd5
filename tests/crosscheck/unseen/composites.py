"""Dynamics of a serial or branched robot in world axes: M by composite bodies about their own centers.

Newton-Euler runs in world axes, C is made of Christoffel's symbols, forward dynamics of articulated bodies about the
world's origin; links on fixed joints are bodies of their own.
"""

import xml.etree.ElementTree as ET

import numpy as np

from tests.crosscheck.unseen.composites_reading import Body, axis_angle, cross, hat, numbers, origin


class Code:
    """The dynamics, as a subject that can be judged."""

    name, version = "composites", "1"

    def __init__(self, urdf, floating=False, gravity=(0.0, 0.0, -9.81)):
        self.g = np.array(gravity, float)
        root = ET.fromstring(urdf)
        links = {x.get("name"): x for x in root.findall("link")}
        joints = root.findall("joint")
        children = {j.find("child").get("link") for j in joints}
        self.bodies = [Body(next(x for name, x in links.items() if name not in children))]
        index = {self.bodies[0].name: 0}
        todo = list(joints)
        self.joints = []
        while todo:
            j = next(x for x in todo if x.find("parent").get("link") in index)
            todo.remove(j)
            b = Body(links[j.find("child").get("link")])
            b.parent = index[j.find("parent").get("link")]
            b.R0, b.p0 = origin(j)
            b.kind = j.get("type")
            if b.kind == "continuous":
                b.kind = "revolute"
            if b.kind != "fixed":
                axis = numbers(j.find("axis"), "xyz", "1 0 0")
                b.axis = axis / np.linalg.norm(axis)
                b.dof = len(self.joints)
                self.joints.append(j.get("name"))
            index[b.name] = len(self.bodies)
            self.bodies.append(b)
        self.index, self.n = index, len(self.joints)
        self.writes = {"q": tuple(self.joints), "v": tuple(self.joints)}

    def poses(self, q):
        """Rotations, origins, axes in the world."""
        R, p, z = [np.eye(3)], [np.zeros(3)], [np.zeros(3)]
        for b in self.bodies[1:]:
            Rj = R[b.parent] @ b.R0
            pj = p[b.parent] + R[b.parent] @ b.p0
            zj = Rj @ b.axis
            if b.kind == "revolute":
                Rj = Rj @ axis_angle(b.axis, q[b.dof])
            elif b.kind == "prismatic":
                pj = pj + zj * q[b.dof]
            R.append(Rj)
            p.append(pj)
            z.append(zj)
        return R, p, z

    def centers(self, R, p):
        return [p[k] + R[k] @ b.com for k, b in enumerate(self.bodies)]

    def tensors(self, R):
        return [R[k] @ b.inertia @ R[k].T for k, b in enumerate(self.bodies)]

    def velocities(self, p, z, v):
        w, u = [np.zeros(3)], [np.zeros(3)]
        for k, b in enumerate(self.bodies[1:], 1):
            i = b.parent
            wk = w[i]
            uk = u[i] + cross(w[i], p[k] - p[i])
            if b.kind == "revolute":
                wk = wk + z[k] * v[b.dof]
            elif b.kind == "prismatic":
                uk = uk + z[k] * v[b.dof]
            w.append(wk)
            u.append(uk)
        return w, u

    def accelerations(self, p, z, w, v, a):
        al, ac = [np.zeros(3)], [np.zeros(3)]
        for k, b in enumerate(self.bodies[1:], 1):
            i = b.parent
            r = p[k] - p[i]
            alk = al[i]
            ack = ac[i] + cross(al[i], r) + cross(w[i], cross(w[i], r))
            if b.kind == "revolute":
                alk = alk + z[k] * a[b.dof] + cross(w[i], z[k]) * v[b.dof]
            elif b.kind == "prismatic":
                ack = ack + z[k] * a[b.dof] + 2.0 * cross(w[i], z[k]) * v[b.dof]
            al.append(alk)
            ac.append(ack)
        return al, ac

    def chain(self, k):
        """The moving bodies from k to the root."""
        while k > 0:
            if self.bodies[k].kind != "fixed":
                yield k
            k = self.bodies[k].parent

    def point_jacobian(self, k, x, p, z):
        """Of the point x that is fixed to body k."""
        Jw, Jv = np.zeros((3, self.n)), np.zeros((3, self.n))
        for i in self.chain(k):
            d = self.bodies[i].dof
            if self.bodies[i].kind == "revolute":
                Jw[:, d] = z[i]
                Jv[:, d] = cross(z[i], x - p[i])
            else:
                Jv[:, d] = z[i]
        return Jw, Jv

    def fk(self, q, frame):
        R, p, _ = self.poses(q)
        k = self.index[frame]
        T = np.eye(4)
        T[:3, :3] = R[k]
        T[:3, 3] = p[k]
        return T

    def jacobian(self, q, frame):
        _, p, z = self.poses(q)
        k = self.index[frame]
        Jw, Jv = self.point_jacobian(k, p[k], p, z)
        return np.vstack([Jw, Jv])

    def frame_velocity(self, q, v, frame):
        _, p, z = self.poses(q)
        w, u = self.velocities(p, z, v)
        k = self.index[frame]
        return np.concatenate([w[k], u[k]])

    def jacobian_dot(self, q, v, frame):
        _, p, z = self.poses(q)
        w, u = self.velocities(p, z, v)
        k = self.index[frame]
        D = np.zeros((6, self.n))
        for i in self.chain(k):
            d = self.bodies[i].dof
            zd = cross(w[i], z[i])
            if self.bodies[i].kind == "revolute":
                D[:3, d] = zd
                D[3:, d] = cross(zd, p[k] - p[i]) + cross(z[i], u[k] - u[i])
            else:
                D[3:, d] = zd
        return D

    def frame_acceleration(self, q, v, a, frame):
        _, p, z = self.poses(q)
        w, _ = self.velocities(p, z, v)
        al, ac = self.accelerations(p, z, w, v, a)
        k = self.index[frame]
        return np.concatenate([al[k], ac[k]])

    def newton_euler(self, q, v, a, g, push=None):
        R, p, z = self.poses(q)
        c, I = self.centers(R, p), self.tensors(R)
        w, _ = self.velocities(p, z, v)
        al, ac = self.accelerations(p, z, w, v, a)
        f, n = [], []
        for k, b in enumerate(self.bodies):
            s = c[k] - p[k]
            acc = ac[k] + cross(al[k], s) + cross(w[k], cross(w[k], s))
            F = b.mass * (acc - g)
            N = I[k] @ al[k] + cross(w[k], I[k] @ w[k])
            f.append(F)
            n.append(N + cross(s, F))
        if push is not None:
            k, wrench = push
            n[k] = n[k] - wrench[:3]
            f[k] = f[k] - wrench[3:]
        tau = np.zeros(self.n)
        for k in range(len(self.bodies) - 1, 0, -1):
            b = self.bodies[k]
            if b.kind == "revolute":
                tau[b.dof] = z[k] @ n[k]
            elif b.kind == "prismatic":
                tau[b.dof] = z[k] @ f[k]
            i = b.parent
            f[i] = f[i] + f[k]
            n[i] = n[i] + n[k] + cross(p[k] - p[i], f[k])
        return tau

    def rnea(self, q, v, a):
        return self.newton_euler(q, v, a, self.g)

    def bias(self, q, v):
        return self.newton_euler(q, v, np.zeros(self.n), self.g)

    def rnea_f_ext(self, q, v, a, f_ext, frame):
        return self.newton_euler(q, v, a, self.g, (self.index[frame], f_ext))

    def gravity(self, q):
        R, p, z = self.poses(q)
        c = self.centers(R, p)
        tau = np.zeros(self.n)
        for k, b in enumerate(self.bodies):
            _, Jv = self.point_jacobian(k, c[k], p, z)
            tau -= Jv.T @ (b.mass * self.g)
        return tau

    def crba(self, q):
        """By composite bodies: mass, center and tensor of everything that a joint carries."""
        R, p, z = self.poses(q)
        m = [b.mass for b in self.bodies]
        c, I = self.centers(R, p), self.tensors(R)
        for k in range(len(self.bodies) - 1, 0, -1):
            i = self.bodies[k].parent
            total = m[i] + m[k]
            if total == 0.0:
                continue
            center = (m[i] * c[i] + m[k] * c[k]) / total
            I[i] = I[i] + self.shift(m[i], c[i] - center) + I[k] + self.shift(m[k], c[k] - center)
            m[i], c[i] = total, center
        M = np.zeros((self.n, self.n))
        for k, b in enumerate(self.bodies):
            if b.kind == "fixed":
                continue
            if b.kind == "revolute":
                F = m[k] * cross(z[k], c[k] - p[k])
                N = I[k] @ z[k]
            else:
                F, N = m[k] * z[k], np.zeros(3)
            for i in self.chain(k):
                if self.bodies[i].kind == "revolute":
                    x = z[i] @ (N + cross(c[k] - p[i], F))
                else:
                    x = z[i] @ F
                M[self.bodies[i].dof, b.dof] = M[b.dof, self.bodies[i].dof] = x
        return M

    def shift(self, m, d):
        """Parallel axes."""
        return m * ((d @ d) * np.eye(3) - np.outer(d, d))

    def mass_derivative(self, q):
        """dM[k] is the derivative of M by q_k."""
        R, p, z = self.poses(q)
        c, I = self.centers(R, p), self.tensors(R)
        n = self.n
        dM = np.zeros((n, n, n))
        for body, b in enumerate(self.bodies):
            if b.mass == 0.0:
                continue
            Jw, Jv = self.point_jacobian(body, c[body], p, z)
            above = list(self.chain(body))
            for k in above:
                dk = self.bodies[k].dof
                turns = self.bodies[k].kind == "revolute"
                dJw, dJv = np.zeros((3, n)), np.zeros((3, n))
                for i in above:
                    di = self.bodies[i].dof
                    before = k in self.chain(i)
                    dz = cross(z[k], z[i]) if turns and before else np.zeros(3)
                    if self.bodies[i].kind == "revolute":
                        dp = np.zeros(3)
                        if before:
                            dp = cross(z[k], p[i] - p[k]) if turns else z[k]
                        dJw[:, di] = dz
                        dJv[:, di] = cross(dz, c[body] - p[i]) + cross(z[i], Jv[:, dk] - dp)
                    else:
                        dJv[:, di] = dz
                half = b.mass * Jv.T @ dJv + Jw.T @ I[body] @ dJw
                dM[dk] += half + half.T
                if turns:
                    dI = hat(z[k]) @ I[body] - I[body] @ hat(z[k])
                    dM[dk] += Jw.T @ dI @ Jw
        return dM

    def coriolis(self, q, v):
        """By Christoffel symbols of the first kind."""
        dM = self.mass_derivative(q)
        C = np.zeros((self.n, self.n))
        for i in range(self.n):
            for j in range(self.n):
                for k in range(self.n):
                    C[i, j] += 0.5 * (dM[k][i, j] + dM[j][i, k] - dM[i][j, k]) * v[k]
        return C

    def minv(self, q):
        """By Cholesky's factor M = L L^T and two substitutions."""
        M, n = self.crba(q), self.n
        L = np.zeros((n, n))
        for j in range(n):
            L[j, j] = np.sqrt(M[j, j] - L[j, :j] @ L[j, :j])
            for i in range(j + 1, n):
                L[i, j] = (M[i, j] - L[i, :j] @ L[j, :j]) / L[j, j]
        X = np.eye(n)
        for i in range(n):
            X[i] = (X[i] - L[i, :i] @ X[:i]) / L[i, i]
        for i in range(n - 1, -1, -1):
            X[i] = (X[i] - L[i + 1 :, i] @ X[i + 1 :]) / L[i, i]
        return X

    def aba(self, q, v, tau):
        """Articulated bodies; spatial vectors [angular; linear] about the world's origin."""
        R, p, z = self.poses(q)
        c, I = self.centers(R, p), self.tensors(R)
        size = len(self.bodies)
        S, V, A, P, bias = [None] * size, [np.zeros(6)] * size, [None] * size, [None] * size, [np.zeros(6)] * size
        for k, b in enumerate(self.bodies):
            if k > 0:
                V[k] = V[b.parent]
                if b.kind != "fixed":
                    if b.kind == "revolute":
                        S[k] = np.concatenate([z[k], cross(p[k], z[k])])
                    else:
                        S[k] = np.concatenate([np.zeros(3), z[k]])
                    V[k] = V[b.parent] + S[k] * v[b.dof]
                    bias[k] = self.motion_cross(V[k], S[k] * v[b.dof])
            C = hat(c[k])
            A[k] = np.block([[I[k] + b.mass * C @ C.T, b.mass * C], [b.mass * C.T, b.mass * np.eye(3)]])
            P[k] = self.force_cross(V[k], A[k] @ V[k])
        U, D, y = [None] * size, [None] * size, [None] * size
        for k in range(size - 1, 0, -1):
            b = self.bodies[k]
            i = b.parent
            if b.kind == "fixed":
                A[i], P[i] = A[i] + A[k], P[i] + P[k]
                continue
            U[k] = A[k] @ S[k]
            D[k] = S[k] @ U[k]
            y[k] = tau[b.dof] - S[k] @ P[k]
            Aa = A[k] - np.outer(U[k], U[k]) / D[k]
            Pa = P[k] + Aa @ bias[k] + U[k] * y[k] / D[k]
            A[i], P[i] = A[i] + Aa, P[i] + Pa
        acc = [np.concatenate([np.zeros(3), -self.g])]
        a = np.zeros(self.n)
        for k, b in enumerate(self.bodies[1:], 1):
            up = acc[b.parent]
            if b.kind != "fixed":
                up = up + bias[k]
                a[b.dof] = (y[k] - U[k] @ up) / D[k]
                up = up + S[k] * a[b.dof]
            acc.append(up)
        return a

    @staticmethod
    def motion_cross(V, W):
        return np.concatenate([cross(V[:3], W[:3]), cross(V[:3], W[3:]) + cross(V[3:], W[:3])])

    @staticmethod
    def force_cross(V, F):
        return np.concatenate([cross(V[:3], F[:3]) + cross(V[3:], F[3:]), cross(V[:3], F[3:])])

    def counted(self):
        """The bodies that move."""
        return [k for k in range(len(self.bodies)) if any(True for _ in self.chain(k))]

    def com(self, q):
        R, p, _ = self.poses(q)
        c = self.centers(R, p)
        total = sum(self.bodies[k].mass for k in self.counted())
        return sum(self.bodies[k].mass * c[k] for k in self.counted()) / total

    def com_jacobian(self, q):
        R, p, z = self.poses(q)
        c = self.centers(R, p)
        J, total = np.zeros((3, self.n)), 0.0
        for k in self.counted():
            _, Jv = self.point_jacobian(k, c[k], p, z)
            J += self.bodies[k].mass * Jv
            total += self.bodies[k].mass
        return J / total

    def centroidal_momentum_matrix(self, q):
        R, p, z = self.poses(q)
        c, I = self.centers(R, p), self.tensors(R)
        G = self.com(q)
        H = np.zeros((6, self.n))
        for k in self.counted():
            m = self.bodies[k].mass
            Jw, Jv = self.point_jacobian(k, c[k], p, z)
            H[:3] += I[k] @ Jw + m * hat(c[k] - G) @ Jv
            H[3:] += m * Jv
        return H

    def kinetic_energy(self, q, v):
        R, p, z = self.poses(q)
        c, I = self.centers(R, p), self.tensors(R)
        w, u = self.velocities(p, z, v)
        T = 0.0
        for k, b in enumerate(self.bodies):
            x = u[k] + cross(w[k], c[k] - p[k])
            T += 0.5 * b.mass * x @ x + 0.5 * w[k] @ I[k] @ w[k]
        return T

    def potential_energy(self, q):
        R, p, _ = self.poses(q)
        c = self.centers(R, p)
        return -sum(self.bodies[k].mass * self.g @ c[k] for k in self.counted())
