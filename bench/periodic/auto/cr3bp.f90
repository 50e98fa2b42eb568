! Circular restricted three-body problem over one period T, t/T in [0, 1], for AUTO-07p.
! u: place, velocity. par: 2 unfolding, 11 period, 12 to 17 first state of guess, 30 energy, 31 mass ratio.
! A force par(2) u' along the velocity makes closing and energy independent conditions; it vanishes on a
! solution (F. J. Munoz-Almaraz et al., Physica D 181 (2003) 1).
subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  use stopwatch, only: resume
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision :: mass(2), to(3, 2), slope(3, 3), r2, pull, t
  integer :: i, k
  call resume()
  t = par(11)
  mass = [1 - par(31), par(31)]
  to(:, 1) = [u(1) + par(31), u(2), u(3)]
  to(:, 2) = [u(1) - 1 + par(31), u(2), u(3)]
  f = [u(4), u(5), u(6), u(1) + 2*u(5), u(2) - 2*u(4), 0d0]
  f(4:6) = f(4:6) + par(2)*u(4:6)
  slope = 0
  slope(1, 1) = 1
  slope(2, 2) = 1
  do k = 1, 2
    r2 = dot_product(to(:, k), to(:, k))
    pull = mass(k)/(r2*sqrt(r2))
    f(4:6) = f(4:6) - pull*to(:, k)
    if (ijac == 0) cycle
    do i = 1, 3
      slope(:, i) = slope(:, i) + 3*pull/r2*to(i, k)*to(:, k)
      slope(i, i) = slope(i, i) - pull
    end do
  end do
  if (ijac == 2) then
    dfdp(:, [1, 2, 11]) = 0
    dfdp(4:6, 2) = t*u(4:6)
    dfdp(:, 11) = f
  end if
  f = t*f
  if (ijac == 0) return
  dfdu = 0
  do i = 1, 3
    dfdu(i, 3 + i) = t
    dfdu(3 + i, 3 + i) = t*par(2)
  end do
  dfdu(4:6, 1:3) = t*slope
  dfdu(4, 5) = 2*t
  dfdu(5, 4) = -2*t
end subroutine func

! Closed, at the guess's phase, with the energy given.
subroutine bcnd(ndim, par, icp, nbc, u0, u1, fb, ijac, dbc)
  implicit none
  integer, intent(in) :: ndim, icp(*), nbc, ijac
  double precision, intent(in) :: par(*), u0(ndim), u1(ndim)
  double precision, intent(out) :: fb(nbc)
  double precision, intent(inout) :: dbc(nbc, *)
  double precision :: mu, r1, r2
  integer :: i
  mu = par(31)
  r1 = sqrt((u0(1) + mu)**2 + u0(2)**2 + u0(3)**2)
  r2 = sqrt((u0(1) - 1 + mu)**2 + u0(2)**2 + u0(3)**2)
  fb(1:6) = u1 - u0
  fb(7) = dot_product(par(15:17), u0(1:3) - par(12:14))
  fb(8) = (dot_product(u0(4:6), u0(4:6)) - u0(1)**2 - u0(2)**2)/2 - (1 - mu)/r1 - mu/r2 - par(30)
  if (ijac == 0) return
  dbc(:, 1:2*ndim) = 0
  if (ijac == 2) dbc(:, 2*ndim + [1, 2, 11]) = 0
  do i = 1, 6
    dbc(i, i) = -1
    dbc(i, 6 + i) = 1
  end do
  dbc(7, 1:3) = par(15:17)
  dbc(8, 1:3) = ((1 - mu)/r1**3 + mu/r2**3)*u0(1:3)
  dbc(8, 1) = dbc(8, 1) + mu*(1 - mu)*(1/r1**3 - 1/r2**3) - u0(1)
  dbc(8, 2) = dbc(8, 2) - u0(2)
  dbc(8, 4:6) = u0(4:6)
end subroutine bcnd
