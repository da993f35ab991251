"""Directional albedos for the glTF oracle by quadrature, with numpy alone: what a microfacet lobe returns of uniform light.

Nothing here is taken from Talbot: GGX with height-correlated Smith shadowing (Heitz 2014), visible normals (Heitz 2018) at the
midpoints of a grid, Schlick's Fresnel; Charlie of Estevez and Kulla 2017; the film of KHR_materials_iridescence.
"""
import numpy as np

NODES = 64  # cosines (k / (NODES - 1))^2: dense at grazing


def cosines():
    return (np.arange(NODES) / (NODES - 1)) ** 2


def visible_normals(ax, ay, wo, n):
    """n x n visible normals of the directions wo[..., 3] and the weights G2 / G1 of their reflections: (cos_d, weight)."""
    u1, u2 = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(n) + 0.5) / n)
    u1, u2 = u1.ravel(), u2.ravel()
    v = wo * [ax, ay, 1]
    v = (v / np.linalg.norm(v, axis=-1, keepdims=True))[..., None, :]
    length = np.hypot(v[..., 0], v[..., 1])
    safe = np.maximum(length, 1e-20)
    t1 = np.stack([np.where(length > 0, -v[..., 1] / safe, 1), np.where(length > 0, v[..., 0] / safe, 0), 0 * length], -1)
    t2 = np.cross(v, t1)
    r, phi = np.sqrt(u1), 2 * np.pi * u2
    a, b = r * np.cos(phi), r * np.sin(phi)
    s = 0.5 * (1 + v[..., 2])
    b = (1 - s) * np.sqrt(1 - a * a) + s * b
    c = np.sqrt(np.maximum(1 - a * a - b * b, 0))
    h = a[..., None] * t1 + b[..., None] * t2 + c[..., None] * v
    h = h * [ax, ay, 1]
    h[..., 2] = np.maximum(h[..., 2], 0)
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    o = wo[..., None, :]
    cos_d = np.clip((h * o).sum(-1), 0, 1)
    i = 2 * cos_d[..., None] * h - o

    def slant(w):
        return np.sqrt((ax * w[..., 0]) ** 2 + (ay * w[..., 1]) ** 2 + w[..., 2] ** 2)

    # G2 / G1 = (1 + Lambda_o) / (1 + Lambda_o + Lambda_i)
    one_o = (1 + slant(o) / np.maximum(o[..., 2], 1e-9)) / 2
    lambda_i = (slant(i) / np.maximum(i[..., 2], 1e-9) - 1) / 2
    return cos_d, np.where(i[..., 2] > 0, one_o / (one_o + lambda_i), 0)


def toward(mu, phi=0.0):
    s = np.sqrt(np.maximum(1 - mu * mu, 0))
    return np.stack([s * np.cos(phi), s * np.sin(phi), mu + 0 * phi], -1)


def schlick_split(ax, ay=None, phi=None, n=48):
    """(a, b) at cosines() x phi: the albedo is F0 a + F90 b."""
    mu = np.maximum(cosines(), 1e-4)
    if phi is None:
        wo = toward(mu)
    else:
        wo = toward(*np.meshgrid(mu, phi, indexing="ij"))
    cos_d, weight = visible_normals(ax, ay or ax, wo, n)
    grazing = (1 - cos_d) ** 5
    return (weight * (1 - grazing)).mean(-1), (weight * grazing).mean(-1)


def reflectance_albedo(ax, reflectance, n=48):
    """Albedo at cosines() of a lobe whose Fresnel term is reflectance(cos_d)[..., 3]."""
    cos_d, weight = visible_normals(ax, ax, toward(np.maximum(cosines(), 1e-4)), n)
    return (weight[..., None] * reflectance(cos_d)).mean(-2)


def hemisphere_mean(values):
    """2 int f(mu) mu dmu of values at cosines()."""
    mu = (np.arange(4000) + 0.5) / 4000
    return (2 * mu * np.interp(np.sqrt(mu), np.linspace(0, 1, NODES), values)).mean()


def charlie_lambda(mu, alpha):
    t = (1 - alpha) ** 2
    rough, sharp = [21.5473, 3.82987, 0.19823, -1.97760, -4.32054], [25.3245, 3.32435, 0.16801, -1.27393, -4.85967]
    a, b, c, d, e = (r + t * (s - r) for r, s in zip(rough, sharp))

    def exponent(x):
        return a / (1 + b * x ** c) + d * x + e

    return np.where(mu < 0.5, np.exp(exponent(np.maximum(mu, 0))), np.exp(2 * exponent(0.5) - exponent(np.clip(1 - mu, 0, 1))))


def charlie_albedo(alpha, n=256):
    """Albedo of the sheen lobe at cosines(), colour 1: int D / ((1 + Lambda_o + Lambda_i) 4 mu_o) dw."""
    mu_o = np.maximum(cosines(), 1e-4)[:, None, None]
    mu_i = ((np.arange(n) + 0.5) / n)[None, :, None]
    phi = ((np.arange(n) + 0.5) / n * np.pi)[None, None, :]
    s_o, s_i = np.sqrt(1 - mu_o ** 2), np.sqrt(1 - mu_i ** 2)
    x, y, z = s_o + s_i * np.cos(phi), s_i * np.sin(phi), mu_o + mu_i
    sin2 = (x * x + y * y) / (x * x + y * y + z * z)
    d = (2 + 1 / alpha) * sin2 ** (0.5 / alpha) / (2 * np.pi)
    g = 1 / (1 + charlie_lambda(mu_o, alpha) + charlie_lambda(mu_i, alpha))
    return (d * g / (4 * mu_o)).mean((1, 2)) * 2 * np.pi


XYZ_TO_SRGB = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560],
                        [0.0556434, -0.2040259, 1.0572252]])


def film_reflectance(mu, ior, nanometres, f0):
    """KHR_materials_iridescence: the fresnel term at cosine mu[...] of a film on a base of normal reflectance f0[3]."""
    mu = np.asarray(mu, float)[..., None]
    f0 = np.clip(np.asarray(f0, float), 0, 0.9999)
    s = np.clip(nanometres / 0.03, 0, 1)
    ior = 1 + (ior - 1) * s * s * (3 - 2 * s)
    cos2 = 1 - (1 - mu ** 2) / ior ** 2
    inside = np.sqrt(np.maximum(cos2, 0))
    r12 = ((ior - 1) / (ior + 1)) ** 2
    r12 = r12 + (1 - r12) * (1 - mu) ** 5
    t121 = 1 - r12
    base = (1 + np.sqrt(f0)) / (1 - np.sqrt(f0))
    r23 = ((base - ior) / (base + ior)) ** 2
    r23 = r23 + (1 - r23) * (1 - inside) ** 5
    path = 2 * ior * nanometres * inside
    phi = (np.pi - (np.pi if ior < 1 else 0)) + np.where(base < ior, np.pi, 0)
    r123 = np.clip(r12 * r23, 1e-5, 0.9999)
    rs = t121 ** 2 * r23 / (1 - r123)
    total, c = r12 + rs, rs - t121
    for m in (1, 2):
        c = c * np.sqrt(r123)
        total = total + c * 2 * sensitivity(m * path, m * phi)
    return np.where(cos2 < 0, 1.0, np.maximum(total, 0))


def sensitivity(path, shift):
    """The extension's Gaussians of the CIE curves; the shift is the one of the colour channel of the base."""
    phase = 2 * np.pi * path * 1e-9
    val, pos, var = np.array([[5.4856e-13, 4.4201e-13, 5.2481e-13], [1.6810e6, 1.7953e6, 2.2084e6],
                              [4.3278e9, 9.3046e9, 6.6121e9]])
    xyz = val * np.sqrt(2 * np.pi * var) * np.cos(pos * phase + shift) * np.exp(-phase ** 2 * var)
    red = 9.7470e-14 * np.sqrt(2 * np.pi * 4.5282e9) * np.cos(2.2399e6 * phase + shift[..., :1]) * np.exp(-4.5282e9 * phase ** 2)
    xyz = xyz + np.concatenate([red, 0 * red, 0 * red], -1)
    return xyz / 1.0685e-7 @ XYZ_TO_SRGB.T
