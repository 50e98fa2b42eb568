! Three unit masses in the plane over one period T, t/T in [0, 1], for AUTO-07p.
! u: x, y, x', y' of the three. par: 2 to 5 unfolding, 11 period, 12 to 23 first state of the guess.
! Unfolding are a force along the velocity, one along each axis and a torque, as energy, momentum and angular
! momentum are conserved; they vanish on a solution (F. J. Munoz-Almaraz et al., Physica D 181 (2003) 1).
subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  use stopwatch, only: resume
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision :: t, apart(2), r2, pull, slope(2, 2)
  integer :: i, j, k, one(2), two(2)
  call resume()
  t = par(11)
  f(1:6) = u(7:12)
  f(7:9) = par(2)*u(7:9) + par(3) - par(5)*u(4:6)
  f(10:12) = par(2)*u(10:12) + par(4) + par(5)*u(1:3)
  if (ijac > 0) then
    dfdu = 0
    do i = 1, 6
      dfdu(i, 6 + i) = t
      dfdu(6 + i, 6 + i) = t*par(2)
    end do
    do i = 1, 3
      dfdu(6 + i, 3 + i) = -t*par(5)
      dfdu(9 + i, i) = t*par(5)
    end do
  end if
  do i = 1, 3
    do j = i + 1, 3
      one = [i, 3 + i]
      two = [j, 3 + j]
      apart = u(one) - u(two)
      r2 = dot_product(apart, apart)
      pull = 1/(r2*sqrt(r2))
      f(6 + one) = f(6 + one) - pull*apart
      f(6 + two) = f(6 + two) + pull*apart
      if (ijac == 0) cycle
      do k = 1, 2
        slope(:, k) = 3*pull/r2*apart(k)*apart
        slope(k, k) = slope(k, k) - pull
      end do
      slope = t*slope
      dfdu(6 + one, one) = dfdu(6 + one, one) + slope
      dfdu(6 + two, two) = dfdu(6 + two, two) + slope
      dfdu(6 + one, two) = dfdu(6 + one, two) - slope
      dfdu(6 + two, one) = dfdu(6 + two, one) - slope
    end do
  end do
  f = t*f
  if (ijac < 2) return
  dfdp(:, 1:5) = 0
  dfdp(7:12, 2) = t*u(7:12)
  dfdp(7:9, 3) = t
  dfdp(10:12, 4) = t
  dfdp(7:9, 5) = -t*u(4:6)
  dfdp(10:12, 5) = t*u(1:3)
end subroutine func

! Closed, at the guess's phase, place and orientation.
subroutine bcnd(ndim, par, icp, nbc, u0, u1, fb, ijac, dbc)
  implicit none
  integer, intent(in) :: ndim, icp(*), nbc, ijac
  double precision, intent(in) :: par(*), u0(ndim), u1(ndim)
  double precision, intent(out) :: fb(nbc)
  double precision, intent(inout) :: dbc(nbc, *)
  double precision :: along(4, 6)
  integer :: i
  along = 0
  along(1, :) = par(18:23)
  along(2, 1:3) = 1
  along(3, 4:6) = 1
  along(4, 1:3) = -par(15:17)
  along(4, 4:6) = par(12:14)
  fb(1:12) = u1 - u0
  fb(13:16) = matmul(along, u0(1:6) - par(12:17))
  if (ijac == 0) return
  dbc(:, 1:2*ndim) = 0
  if (ijac == 2) dbc(:, 2*ndim + 1:2*ndim + 5) = 0
  do i = 1, 12
    dbc(i, i) = -1
    dbc(i, 12 + i) = 1
  end do
  dbc(13:16, 1:6) = along
end subroutine bcnd
