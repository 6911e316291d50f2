import numba, numpy as np
from math import log, sqrt
from dropflow.detection.default.rays import N_RAYS, N_STEPS, STEP, sample, find_edges, fit_circle, mean_profile, _fall
PROFILE_AT=(0,4,8,11,13,15,17,19,20,21,23,25,27,30,34)
NAMES=['log_r','inside','spread','edge_fraction','inlier_drop_noise','contrast_noise','drop_over_contrast','min_sector','min2_sector','strong_fraction','noise_fraction','drop_cv','ring_std','inner_std','width','skew','mid','dip','outer_level','match','drop_ref','contrast_ref']+['p%d'%j for j in PROFILE_AT]
N=len(NAMES)
@numba.njit(cache=True, nogil=True, error_model="numpy")
def crossing(profile, top, bottom, share, first, last):
    target=bottom+(top-bottom)*share
    for j in range(first,last):
        a,b=profile[j],profile[j+1]
        if a>=target and b<target:
            return (j+(a-target)/(a-b))*STEP
    return np.nan
@numba.njit(cache=True, nogil=True, error_model="numpy")
def features(image, x, y, r, spread, noise, level, out):
    """noise: sd of a pixel at this level; level: factor."""
    polar=np.empty((N_RAYS,N_STEPS),np.float32)
    edge,drop,circle,weight=np.empty(N_RAYS),np.empty(N_RAYS),np.empty(3),np.empty(N_RAYS)
    fall=np.empty(N_RAYS); prof=np.empty(N_STEPS); ones=np.ones(N_RAYS)
    rows,cols=image.shape
    for i in range(x.size):
        if not spread[i]>=0: 
            out[i,:]=np.nan; continue
        sample(image,x[i],y[i],r[i],polar)
        find_edges(polar,0.12,edge,drop)
        fit_circle(edge,drop,circle,weight)
        n_in=0; n_edge=0; s=0.; ws=0.
        for k in range(N_RAYS):
            fall[k]=0.5*_fall(polar,k,20)+0.25*(_fall(polar,k,19)+_fall(polar,k,21))
            if fall[k]==fall[k]:
                n_in+=1
            else: fall[k]=0.; weight[k]=0.; continue
            if drop[k]>0 and abs(edge[k]-1)<0.12: n_edge+=1
            if weight[k]>0.: s+=weight[k]*drop[k]; ws+=weight[k]
        if n_in<8 or ws<=0:
            out[i,:]=np.nan; continue
        typical=s/ws
        mean_profile(polar,weight,prof)
        inner=0.;n=0
        for j in range(0,14): 
            inner+=prof[j]; n+=1
        inner/=n
        outer=0.;n=0
        for j in range(25,33):
            if prof[j]==prof[j]: outer+=prof[j]; n+=1
        outer=outer/max(n,1)
        contrast=inner-outer
        sn=noise/sqrt(r[i]*r[i]*0.03+1.0)
        o=out[i]
        o[0]=log(r[i]*level); o[1]=n_in/N_RAYS; o[2]=spread[i]; o[3]=n_edge/n_in
        o[4]=log(max(typical,1e-3*noise)/noise*sqrt(1+r[i])); o[5]=log(max(contrast,1e-2*noise)/noise)
        o[6]=typical/max(abs(contrast),1e-3*noise)
        # sectors
        m1=1e9;m2=1e9
        for q in range(8):
            t=0.;c=0
            for k in range(q*4,q*4+4):
                if polar[k,23]==polar[k,23]:
                    t+=fall[k]; c+=1
            if c>=2:
                t/=c
                if t<m1: m2=m1; m1=t
                elif t<m2: m2=t
        o[7]=m1/typical; o[8]=m2/typical
        a=0;b=0;mean=0.;sq=0.
        for k in range(N_RAYS):
            if polar[k,23]==polar[k,23]:
                if fall[k]>0.5*typical: a+=1
                if fall[k]>3*noise: b+=1
                mean+=fall[k]; sq+=fall[k]**2
        o[9]=a/n_in; o[10]=b/n_in
        mean/=n_in; o[11]=sqrt(max(sq/n_in-mean*mean,0.))/typical
        for which in range(2):
            j0=25 if which==0 else 12
            t=0.;t2=0.;c=0
            for k in range(N_RAYS):
                v=(polar[k,j0]+polar[k,j0+1]+polar[k,j0+2])/3
                if v==v: t+=v; t2+=v*v; c+=1
            if c>0: o[12+which]=sqrt(max(t2/c-(t/c)**2,0.))/typical
            else: o[12+which]=np.nan
        top=max(prof[11],prof[13]); bottom=min(prof[26],prof[30]) if prof[30]==prof[30] else prof[26]
        q1=crossing(prof,top,bottom,.75,8,36); q2=crossing(prof,top,bottom,.5,8,36); q3=crossing(prof,top,bottom,.25,8,36)
        o[14]=q3-q1; o[15]=(q3-q2)-(q2-q1); o[16]=q2
        o[17]=(prof[0]-prof[12])/typical
        o[18]=outer
        # match eq 3 like, scale free: asymmetry of the ring's light
        sx=0.;sy=0.;c=0
        for k in range(N_RAYS):
            v=polar[k,26]
            if v==v:
                sx+=(v-outer)*np.cos(2*np.pi*k/N_RAYS); sy+=(v-outer)*np.sin(2*np.pi*k/N_RAYS); c+=1
        o[19]=sqrt(sx*sx+sy*sy)/c/typical
        o[20]=typical; o[21]=contrast
        for q in range(len(PROFILE_AT)):
            o[22+q]=(prof[PROFILE_AT[q]]-outer)/typical
